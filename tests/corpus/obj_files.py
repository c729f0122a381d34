"""OBJ files that lie."""

from __future__ import annotations

from corpus.answers import CORNERS, GOOD, NO_NUMBERS, ONES, TETRAHEDRON, Mesh, Rows, named

V = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
F = "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
OBJ = V + F


def obj() -> Rows:
    yield from named("obj", OBJ_READABLE + OBJ_DAMAGED)
    for k, (name, word) in enumerate(NO_NUMBERS.items()):
        yield f"number {name}.obj", OBJ.replace("v 1 0 0", f"v 1 {word} 0"), "line 2: found"
        if k % 3 == 0:
            yield f"index {name}.obj", OBJ.replace("f 2 3 4", f"f 2 {word} 4"), "line 7: (found|face 2)"
    for k, word in enumerate(ONES):
        yield f"one as spelling {k}.obj", OBJ.replace("v 1 0 0", f"v {word} 0 -0"), GOOD


OBJ_READABLE: list[tuple[str, str | bytes, Mesh | str]] = [
    ("plain", OBJ, GOOD),
    ("normals named, but none there", OBJ.replace("f 1 3 2", "f 1//1 3//1 2//1"), GOOD),
    (
        "all normals named, but none there",
        V + "".join("f " + " ".join(f"{w}//{w}" for w in line.split()[1:]) + "\n" for line in F.splitlines()),
        GOOD,
    ),
    ("crlf", OBJ.replace("\n", "\r\n"), GOOD),
    ("cr", OBJ.replace("\n", "\r"), GOOD),
    ("byte order mark", "\ufeff" + OBJ, GOOD),
    ("no last line end", OBJ.rstrip("\n"), GOOD),
    ("relative indices", V + "f -4 -2 -3\nf -4 -3 -1\nf -3 -2 -1\nf -2 -4 -1\n", GOOD),
    (
        "relative indices at their place",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -1 -2\nv 0 0 1\nf 1 2 4\nf -3 -2 -1\nf -2 -4 -1\n",
        GOOD,
    ),
    ("relative and absolute indices", OBJ.replace("f 2 3 4", "f 2 -2 4"), GOOD),
    ("faces before vertices", F + V, GOOD),
    ("texture and normals", V + "vt 0 0\nvn 0 0 1\n" + F.replace("f 1 3 2", "f 1/1 3//1 2/1/1"), GOOD),
    (
        "all per corner",
        V
        + "vt 0 0\nvn 0 0 1\n"
        + "".join("f " + " ".join(f"{w}/1/1" for w in line.split()[1:]) + "\n" for line in F.splitlines()),
        GOOD,
    ),
    ("slashes with nothing", OBJ.replace("f 2 3 4", "f 2/ 3// 4"), GOOD),
    ("colours", V.replace("\n", " 1 0.5 0\n") + F, GOOD),
    ("weights", V.replace("\n", " 1.0\n") + F, GOOD),
    ("colours in some vertices", OBJ.replace("v 1 0 0", "v 1 0 0 1 0 0"), Mesh(CORNERS, TETRAHEDRON, warned=True)),
    ("continuation lines", OBJ.replace("f 1 3 2", "f 1 \\\n 3 \\\n2").replace("v 1 0 0", "v 1 \\\r\n0 0"), GOOD),
    ("groups and materials", "mtllib a.mtl\no a\ng b c\ns 1\n" + V + "usemtl x\ns off\n" + F + "l 1 2\np 1\n", GOOD),
    ("material outside the folder", "mtllib ../../../etc/passwd\nmtllib /etc/shadow\n" + OBJ, GOOD),
    ("material at a pipe", "mtllib /dev/stdin\n" + OBJ, GOOD),
    ("names in latin-1", b"o gr\xfcn\ng \xff\n" + OBJ.encode(), GOOD),
    ("comments in latin-1", b"# gr\xfcn\n" + OBJ.replace("f 2 3 4", "f 2 3 4 # \u2713").encode(), GOOD),
    ("a comment of five million bytes", "#" + "x" * 5_000_000 + "\n" + OBJ, GOOD),
    ("a name of five million bytes", "o " + "x" * 5_000_000 + "\n" + OBJ, GOOD),
    ("tabs and blanks", OBJ.replace(" ", " \t ").replace("\n", "  \n\n"), GOOD),
    ("a polygon", V + "v 1 1 1\nf 1 2 3 4 5\nf 5 4 3\n", Mesh([*CORNERS, [1, 1, 1]], [[0, 1, 2, 3, 4], [4, 3, 2]])),
    (
        "a vertex twice in a quad",
        OBJ.replace("f 2 3 4", "f 2 3 2 4"),
        Mesh(CORNERS, [*TETRAHEDRON[:2], [1, 2, 1, 3], TETRAHEDRON[3]]),
    ),
    (
        "normals that differ",
        V + "vn 0 0 1\nvn 1 0 0\n" + "f 1//1 3//1 2//1\nf 1//2 2//2 4//2\nf 2//1 3//1 4//1\nf 3//1 1//1 4//1\n",
        GOOD,
    ),
]

OBJ_DAMAGED: list[tuple[str, str | bytes, Mesh | str]] = [
    ("empty", "", "empty"),
    ("only comments", "# a\n# b\n", "no faces"),
    ("only vertices", V, "no faces"),
    ("only faces", F, "line 1.*only 0"),
    ("other words", "hello\n" + OBJ, "line 1.*'hello'"),
    ("free-form curve", OBJ + "cstype bezier\n", "line 9.*'cstype'"),
    ("index zero", OBJ.replace("f 2 3 4", "f 2 0 4"), "line 7.*index 0"),
    ("index too large", OBJ.replace("f 2 3 4", "f 2 3 5"), "line 7.*face 2 names vertex"),
    ("relative index too far", OBJ.replace("f 2 3 4", "f 2 -5 4"), "line 7.*names vertex"),
    ("relative index before its vertex", "v 0 0 0\nv 1 0 0\nf -1 -2 -3\nv 0 1 0\n", "line 3.*names vertex"),
    ("index of a million million", OBJ.replace("f 2 3 4", "f 2 1000000000000 4"), "line 7"),
    ("index of twenty digits", OBJ.replace("f 2 3 4", "f 2 18446744073709551617 4"), "line 7"),
    ("index with a fraction", OBJ.replace("f 2 3 4", "f 2 2.5 4"), "line 7.*2.5"),
    (
        "normal index too large",
        V
        + "vn 0 0 1\n"
        + "".join("f " + " ".join(f"{w}//9" for w in line.split()[1:]) + "\n" for line in F.splitlines()),
        "line 6.*normal",
    ),
    ("three slashes", OBJ.replace("f 2 3 4", "f 2 3/1/1/1 4"), "line 7.*'3/1/1/1'"),
    ("slash first", OBJ.replace("f 2 3 4", "f 2 /3 4/1"), "line 7.*'/3'"),
    ("backslash for a slash", OBJ.replace("f 2 3 4", "f 2\\1 3\\1 4\\1"), "line 7"),
    ("face of two", OBJ.replace("f 2 3 4", "f 2 3"), "line 7.*2 corners"),
    ("face of one", OBJ.replace("f 2 3 4", "f 2"), "line 7.*1 corner"),
    ("face of none", OBJ.replace("f 2 3 4", "f"), "line 7.*0 corner"),
    ("face of one vertex", OBJ.replace("f 2 3 4", "f 2 2 2"), "face 2 has the vertices 1 1 1"),
    ("a coordinate too few", OBJ.replace("v 1 0 0", "v 1 0"), "line 2.*2 numbers"),
    ("no coordinates", OBJ.replace("v 1 0 0", "v"), "line 2.*0 numbers"),
    ("five numbers", OBJ.replace("v 1 0 0", "v 1 0 0 1 1"), "line 2.*5 numbers"),
    ("eight numbers", OBJ.replace("v 1 0 0", "v 1 0 0 1 1 1 1 1"), "line 2.*8 numbers"),
    ("normal of two", "vn 0 1\n" + OBJ, "line 1.*2 numbers"),
    ("normal of nan", "vn 0 1 nan\n" + OBJ, "line 1.*'nan'"),
    ("colour of a thousand", V.replace("\n", " 1000 0 0\n") + F, "colour"),
    ("continued past the end", OBJ + "f 1 2 \\\n", "line 9"),
    ("error after a continuation", OBJ.replace("f 1 3 2", "f 1 \\\n3 2").replace("f 2 3 4", "f 2 3 x"), "line 8.*'x'"),
    ("vertex after a continued comment", "v 1 \\\n" + OBJ, "line 1"),
    ("cut in a face", OBJ[:-4], "line 8.*1 corner"),
    ("cut in a vertex", V[:-4], "no faces|numbers"),
    ("zero byte", OBJ + "\0", "line 9.*zero byte"),
    ("control byte", OBJ.replace("v 1 0 0", "v 1 0 \x01 0"), "line 2.*byte 1"),
    ("utf-16", OBJ.encode("utf-16"), "UTF-16"),
    ("this is ply", "ply\nformat ascii 1.0\n", "line 1.*'ply'"),
]
