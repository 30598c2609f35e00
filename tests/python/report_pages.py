# SPDX-License-Identifier: BSD-3-Clause
"""Pages of `slipfront report`, and what their plots are drawn from."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path

from slipfront.report.command import KINDS, Kind, main


def page_of(folder: Path, file: Path | None = None, kinds: Sequence[Kind] = KINDS) -> str:
    """The page of a folder, without the library in it."""
    assert main([str(folder), *(["-o", str(file)] if file else [])], kinds) == 0
    text = (file or folder / "report.html").read_text(encoding="utf-8")
    return re.sub(r"<script>[\s\S]*?</script>", "<script></script>", text)


def data_of(text: str) -> dict:
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text)[1])
