# SPDX-License-Identifier: BSD-3-Clause
"""What the package raises; the text of each is one line, the one that the program prints."""

#: Of names and commands.
NEEDS_MODULE = "the compiled module: in the sources, 'make module' builds it; elsewhere 'pip install .' does"


def one_line(text: str) -> str:
    """The text without line breaks, control characters and bytes that no encoding prints."""
    return "".join(c if c.isprintable() else "?" for c in text)


class Error(Exception):
    """Whatever is refused or cannot be done."""

    def __str__(self) -> str:
        return one_line(super().__str__())


class CaseError(Error, ValueError):
    """A case, an array or what else was given cannot be used; the text says where and what to do."""


class BlowUpError(Error, ArithmeticError):
    """The computed motion is no longer physical."""


class WriteError(Error, OSError):
    """The system refuses to write or keep a file."""
