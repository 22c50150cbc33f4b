# SPDX-License-Identifier: GPL-3.0-or-later
"""What the library throws, as exceptions."""

_OF_INPUT = (64, 65, 78)


class Error(Exception):
    """str() is one line; where a file or a result is wrong, the line that the program prints. exit_code is one of
    docs/reference/exit-codes.md; file and field say where, and may be empty."""

    def __init__(self, exit_code: int, line: str, file: str = "", field: str = ""):
        super().__init__(line)
        self.exit_code, self.file, self.field = exit_code, file, field

    def __reduce__(self):
        return type(self), (self.exit_code, str(self), self.file, self.field)


class InputError(Error, ValueError):
    """Something that was given is wrong: data, or the name or range of a parameter (65), a choice (64, 78)."""


def make(exit_code: int, line: str, file: str, field: str) -> Error:
    return (InputError if exit_code in _OF_INPUT else Error)(exit_code, line, file, field)
