"""Options: the keyword-only arguments of a component, which come from the configuration."""

from __future__ import annotations

import inspect
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import UnionType
from typing import Any, Literal, get_args, get_origin

from orbiframe.components.shown_text import shown
from orbiframe.components.suggestion import did_you_mean
from orbiframe.errors import ConfigError

# Beyond these no option of any component makes sense, and libraries fail in ways of their own.
_MOST_BITS, _DEEPEST = 256, 20
_SHOULD_BE = "Input should be "


@dataclass(frozen=True, slots=True)
class Option:
    """One option of a component: its name, its type and its default (`inspect.Parameter.empty` where there is none)."""

    name: str
    annotation: Any
    default: Any

    @property
    def type_name(self) -> str:
        """The type as one writes it in Python."""
        return inspect.formatannotation(self.annotation)

    @property
    def required(self) -> bool:
        """Whether a value must be given."""
        return self.default is inspect.Parameter.empty


def options_of(target: Callable[..., Any]) -> list[Option]:
    """The options of a class or function, read off its signature, in its order.

    >>> from orbiframe import Registry
    >>> from orbiframe.components import options_of
    >>> [(o.name, o.default) for o in options_of(Registry.discover().load("fitter", "sliding"))]
    [('fairing', None), ('steps', 5)]
    """
    keywords = [p for p in inspect.signature(target).parameters.values() if p.kind is inspect.Parameter.KEYWORD_ONLY]
    return [Option(p.name, _evaluated(p.annotation, target), p.default) for p in keywords]


def checked_options(
    target: Callable[..., Any], given: Mapping[str, object], table: str, places: Mapping[str, str], selector: str = ""
) -> dict[str, Any]:
    """The given options with the types that the signature asks for; a list becomes a tuple where one is asked for.

    table: name of the configuration table; places: where each "table.key" was written; selector: the key of the table
    that has chosen the target, if there is one. Raises ConfigError for an unknown option, a value of another type, and
    a missing one; the sentence names the place and what is allowed.
    """
    options = {option.name: option for option in options_of(target)}
    known = {selector: None, **options} if selector else options
    for key in given:
        require_known(key, known, table, places)
    for option in options.values():
        if option.required and option.name not in given:
            raise ConfigError(
                f"[{table}] needs the option '{option.name}' ({option.type_name}); set {table}.{option.name}"
            )
    return {
        key: checked_value(options[key].annotation, value, f"{table}.{key}", places) for key, value in given.items()
    }


def require_known(key: str, known: Mapping[str, object], table: str, places: Mapping[str, str]) -> None:
    """Raise ConfigError if `key` is no key of a configuration table; the sentence names the nearest one and all."""
    if key not in known:
        allowed = ", ".join(known) or "none"
        place = place_of(f"{table}.{key}", places)
        raise ConfigError(
            f"{place}[{table}] has no option '{shown(key, 100)}'; allowed: {allowed}.{did_you_mean(key, known)}"
        )


def checked_value(annotation: Any, value: object, key: str, places: Mapping[str, str]) -> Any:
    """The value as the type that the annotation asks for; raises ConfigError where it is of another type."""
    _require_small(value, key, places)
    if _is_plainly(annotation, value):
        return value
    from pydantic import ValidationError

    try:
        # TOML has the types of JSON, where a tuple is a list; strict, so that "3" is no number and 1 no truth value.
        return _adapter(annotation).validate_json(json.dumps(value, default=str), strict=True)
    except ValidationError as error:
        found = [(_place_inside(each["loc"]), each["msg"]) for each in error.errors(include_url=False)]
        inner, first = found[0]
        # Of a choice of types, each has a reason of its own.
        others = [text.removeprefix(_SHOULD_BE) for place, text in found[1:] if place == inner and text != first]
        reason = " or ".join([first[0].lower() + first[1:], *dict.fromkeys(others)])
        raise ConfigError(f"{place_of(key, places)}{key}{inner} = {shown(repr(value), 200)}: {reason}") from error


def _is_plainly(annotation: Any, value: object) -> bool:
    """Whether a value is of a type without any question, so that pydantic, which takes long to import, is not asked."""
    kinds = get_args(annotation) if isinstance(annotation, UnionType) else (annotation,)
    if type(value) in kinds:
        return value.isascii() if isinstance(value, str) else value is None or isinstance(value, bool | int | float)
    return isinstance(value, str) and any(get_origin(kind) is Literal and value in get_args(kind) for kind in kinds)


def _place_inside(steps: Sequence[int | str]) -> str:
    """Which item of a list, or of a list in it."""
    return "".join(f"[{step}]" for step in steps if isinstance(step, int))


def _require_small(value: object, key: str, places: Mapping[str, str], depth: int = 0) -> None:
    """Raise ConfigError for numbers that are not finite or have hundreds of digits, and for tables within tables."""
    problem = ""
    if isinstance(value, float) and not math.isfinite(value):
        problem = f"{value} is no finite number"
    elif isinstance(value, int) and value.bit_length() > _MOST_BITS:
        problem = f"the number has about {value.bit_length() * 3 // 10} digits"
    elif depth > _DEEPEST:
        problem = f"lists and tables are nested more than {_DEEPEST} deep"
    if problem:
        raise ConfigError(f"{place_of(key, places)}{key}: {problem}; give another value")
    if isinstance(value, Mapping | list | tuple):
        for item in value.values() if isinstance(value, Mapping) else value:
            _require_small(item, key, places, depth + 1)


@lru_cache(maxsize=256)
def _cached_adapter(annotation: Any) -> Any:
    from pydantic import TypeAdapter

    return TypeAdapter(annotation)


def _adapter(annotation: Any) -> Any:
    return _cached_adapter(Any if annotation is inspect.Parameter.empty else annotation)


def place_of(key: str, places: Mapping[str, str]) -> str:
    """The place where a key was written, as the beginning of a sentence; empty where it is unknown."""
    return f"{places[key]}: " if key in places else ""


def _evaluated(annotation: Any, target: Callable[..., Any]) -> Any:
    if not isinstance(annotation, str):
        return annotation
    function = inspect.unwrap(target.__init__ if isinstance(target, type) else target)  # type: ignore[misc]
    return eval(annotation, dict(getattr(function, "__globals__", {})))
