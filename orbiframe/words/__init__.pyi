"""The public names of orbiframe.words, each with the module it lives in."""

from .conway_symbol import ConwaySymbol as ConwaySymbol
from .mirror_word import MirrorWord as MirrorWord, Relations as Relations, word_of as word_of
from .presentation import Presentation as Presentation
from .word import (
    Word as Word,
    inverse_letters as inverse_letters,
    reduced_letters as reduced_letters,
    standard_word as standard_word,
    text_of as text_of,
)
