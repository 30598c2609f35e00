# SPDX-License-Identifier: BSD-3-Clause
"""The page on clusters shows the job script that `make slurm-mpi-trial` runs."""

import os
import re

import pytest
from common import ROOT, call, require_done


def test_the_page_has_the_script():
    page = (ROOT / "docs/cluster.md").read_text(encoding="utf-8")
    shown = re.findall(r"^```bash\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    assert shown == [(ROOT / "scripts/slurm-run.sh").read_text(encoding="utf-8")]


@pytest.mark.parametrize("begun", [None, ".slipfront.lock", "unfinished", "publishing", "run.json"])
def test_the_script_goes_on_with_what_was_begun(tmp_path, begun):
    """Publishing is what a run does last, killed before it has moved run.json."""
    srun = tmp_path / "bin/srun"
    srun.parent.mkdir()
    srun.write_text('#!/bin/sh\necho "$@"\n')
    srun.chmod(0o755)
    if begun is not None:
        (tmp_path / "out" / begun).mkdir(parents=True)
    environment = os.environ | {"PATH": f"{srun.parent}:{os.environ['PATH']}"}
    script = ("bash", ROOT / "scripts/slurm-run.sh", "case.toml", "out")
    result = require_done(call(*script, cwd=tmp_path, env=environment))
    goes_on = begun in ("unfinished", "publishing", "run.json")
    assert ("run --restart out " if goes_on else "run case.toml -o out ") in result.stdout
