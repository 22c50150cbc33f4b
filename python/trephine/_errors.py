# SPDX-License-Identifier: GPL-3.0-or-later
"""What the library throws, as exceptions."""

_OF_INPUT = (64, 65, 78)


class Error(Exception):
    """str() is the line that the program prints. exit_code is the program's (docs/reference/exit-codes.md); file and field say
    where, and may be empty."""

    def __init__(self, exit_code: int, line: str, file: str = "", field: str = ""):
        super().__init__(line)
        self.exit_code, self.file, self.field = exit_code, file, field

    def __reduce__(self):
        return type(self), (self.exit_code, str(self), self.file, self.field)


class InputError(Error, ValueError):
    """Something that was given is wrong: data (65), a parameter (64, 78)."""


def make(exit_code: int, line: str, file: str, field: str) -> Error:
    return (InputError if exit_code in _OF_INPUT else Error)(exit_code, line, file, field)
