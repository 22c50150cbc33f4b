# SPDX-License-Identifier: GPL-3.0-or-later
"""Parameters on their way to the library, which knows their names and ranges."""
import json
import os
from typing import Any, Mapping

import numpy as np


def _plain(value: Any) -> Any:
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise ValueError(f"a value of type {type(value).__name__} is no parameter")


def to_json(params: Mapping[str, Any]) -> str:
    for name, value in params.items():
        try:
            json.dumps(value, default=_plain, allow_nan=False)
        except ValueError as error:
            what = "is not finite" if "JSON compliant" in str(error) else str(error)
            raise ValueError(f"{name}: {what}") from None
    return json.dumps(params, default=_plain)
