# SPDX-License-Identifier: BSD-3-Clause
"""What is found wrong after a case was read is told with the line of the key at fault."""

import re

import pytest
from common import ROOT, refusal, sets

PLATE = "[plate]\nwidth_m = 0.2\nheight_m = 0.1\nelement_size_m = 5e-3\n"
COARSE = PLATE + 'corner = "relief"\n'
SQUARE = PLATE + 'corner = "none"\n'
RIGID = '[base]\nkind = "rigid"\n'
PRESSED = '[loading]\nmethod = "prestress"\n[prestress]\nt_Pa = 2.1e6\np_Pa = 5e6\n[event]\nkind = "none"\n'
TABLED = PRESSED.replace("t_Pa = 2.1e6\np_Pa = 5e6\n", 'file = "table.csv" # here\n')
WEAKENING = '[friction]\nlaw = "slip_weakening"\nmu_s = 0.6\nmu_k = 99.9\n'
STEEL = (
    '[base]\nkind = "body"\nyoungs_modulus_Pa = 2e11\npoissons_ratio = 0.3\ndensity_kg_per_m3 = 7800\n'
    "stiffness_damping_s = 1e-7\n"
)

# The line to be named ends with "# here"; where none does, it is the override.
CASES = [
    (COARSE, "plate.width_m=0.2001"),
    ("[plate]\nheight_m = 0.1003 # here\n", None),
    (COARSE + "coarsenings = 5 # here\nfine_height_m = 5e-3\n", None),
    (COARSE + "coarsenings = 1\nfine_height_m = 0.01\n", "plate.fine_height_m=0.09"),
    (COARSE + "relief_length_m = 1e-3 # here\n", None),
    (COARSE + "relief_length_m = 0.06\n", "plate.width_m=0.1"),
    (COARSE + "relief_height_m = 5e-3 # here\nrelief_length_m = 9e-3\n", None),
    (COARSE + "relief_height_m = 5e-3\nrelief_length_m = 0.02\n", "plate.relief_length_m=9e-3"),
    (COARSE + "relief_depth_m = 0.2 # here\n", None),
    (COARSE + "relief_depth_m = 1e-4 # here\n", None),
    (COARSE + 'sides = "absorbing" # here\n', None),
    (SQUARE + 'sides = "absorbing"\n', "plate.corner=relief"),
    ('[plate]\ncorner = "fillet"\nelement_size_m = 0.05 # here\n' + RIGID, None),
    (
        '[plate]\nwidth_m = 0.2\nheight_m = 0.1\nelement_size_m = 0.1\nsides = "periodic" # here\n' + PRESSED,
        None,
    ),
    (SQUARE + "[time]\ninterface_rows = 3\n", "time.interface_rows=30"),
    ('[plate]\nwidth_m = 0.2\ncorner = "none"\nelement_size_m = 0.05 # here\n', None),
    ("[plate]\nelement_size_m = 0.05 # here\n", None),
    (COARSE + "[loading]\ntilt_left_m = 0.0 # here\ntilt_right_m = 0.0\n", None),
    (COARSE + "[time]\ninterface_rows = 1 # here\n" + STEEL + "height_m = 5e-3\n", None),
    (SQUARE + 'sides = "periodic" # here\n', None),
    (SQUARE + 'top = "free" # here\n', None),
    (COARSE + STEEL + 'height_m = 0.1\nbottom = "free" # here\n', None),
    (COARSE + STEEL + "height_m = 0.1001 # here\n", None),
    (SQUARE + 'sides = "absorbing"\n' + PRESSED + '[time]\nprecision = "single" # here\n', None),
    (SQUARE + PRESSED + '[time]\nprecision = "single"\n', "plate.sides=absorbing"),
    (SQUARE + TABLED, None),
    (SQUARE + TABLED.replace(" # here", ""), "prestress.file=none.csv"),
    (COARSE + WEAKENING + 'random_key = "mu_k"\nrandom_share = 0.5 # here\n', None),
    (COARSE + WEAKENING + 'random_key = "mu_k" # here\n', None),
    (COARSE + WEAKENING, "friction.random_key=mu_k"),
    (COARSE + '[loading]\nsolver = "iterative" # here\n' + STEEL + "coarsenings = 1\n", None),
    (COARSE + '[loading]\nsolver = "iterative"\n' + STEEL, "base.coarsenings=1"),
]


def place(case, text, override):
    if override:
        return f"--set {override}: "
    (line,) = [k for k, line in enumerate(text.splitlines(), 1) if line.endswith("# here")]
    return f"{case}:{line}: "


@pytest.mark.parametrize("text, override", CASES)
def test_the_line_is_that_of_the_key_at_fault(program, write_case, tmp_path, text, override):
    (tmp_path / "table.csv").write_text("x_m,t_Pa,p_Pa\n0,2.1e6,5e6\n0.1,2.1e6,5e6\n")
    case = write_case(text)
    printed = refusal(program("validate", case, *(sets(override) if override else [])))
    assert printed.startswith(place(case, text, override))


# And what the message says.
LATE = [
    (
        'mu_s = 1.3\n[event]\nkind = "right"\ntrigger_form = "raised"\ntrigger_over_strength = 1e-3 # here\n',
        None,
        ["event.trigger_over_strength = 0.001 adds no traction", "choose more than"],
    ),
    (
        'mu_s = 1.3\n[event]\nkind = "right"\ntrigger_form = "raised"\n',
        "event.trigger_over_strength=1e-3",
        [],
    ),
    # At this strength slip spreads from the edges before t/p inside reaches it.
    ("mu_s = 100 # here\n[loading]\nedge_margin_m = 5e-3\n", None, ["mu_s"]),
    # The peak t/p of the tilted plate is about 0.5.
    ("mu_s = 0.1 # here\nmu_k = 0.05\n", None, ["tilt"]),
    # The margins at both ends leave nothing inside; mu_s comes first, or the margin that is set.
    ("mu_s = 1.2 # here\n[loading]\nedge_margin_m = 0.0999\n", None, ["mu_s", "edge_margin_m"]),
    ("mu_s = 1.2\n", "loading.edge_margin_m=0.0999", []),
]


@pytest.mark.parametrize("text, override, words", LATE)
def test_the_line_is_that_of_what_only_the_statics_find(program, write_case, tmp_path, text, override, words):
    text = COARSE + RIGID + "[friction]\nlaw = 'velocity_weakening'\n" + text
    case = write_case(text)
    printed = refusal(program("run", case, "-o", "out", *(sets(override) if override else [])))
    assert printed.startswith(place(case, text, override))
    for word in words:
        assert word in printed
    assert not (tmp_path / "out").exists()


# --- Keys in the sources

CARRIED = re.compile(r'(?:\bKey(?: \w+)?|\.about)\(((?:[^()"]|"[^"]*")*)\)')


def keys_of(reference):
    table = ""
    for line in reference.splitlines():
        if found := re.match(r"## \[(\w+)\]", line):
            table = found[1] + "."
        if found := re.match(r"\| `(\w+)` \|", line):
            yield table + found[1]


def test_keys_that_errors_carry_are_those_of_the_schema(program):
    keys = set(keys_of(program("keys").stdout))
    sources = [file.read_text(encoding="utf-8") for file in (ROOT / "src").glob("*/**/*.[ch]pp")]
    carried = {
        key for text in sources for call in CARRIED.findall(text) for key in re.findall(r'"([^"]*)"', call)
    }
    assert carried
    assert carried <= keys | {"{}.coarsenings", "{}.fine_height_m"}  # of plate or base


def thrown(text):
    """What stands between the parentheses of each UserError that is thrown."""
    for found in re.finditer(r"throw UserError\(", text):
        depth, end = 1, found.end()
        while depth:
            if text[end] == '"':
                end = re.compile(r'"(?:[^"\\]|\\.)*"').match(text, end).end()
                continue
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        yield text[found.end() : end]


def test_errors_carry_the_keys_that_they_name(program):
    """A key that is written into the text of a message would not be looked up."""
    keys = [key for key in keys_of(program("keys").stdout) if "." in key]
    named = re.compile(r"(?<![\w.])(?<!--set )(" + "|".join(map(re.escape, keys)) + r")\b")
    for file in (ROOT / "src").glob("*/**/*.[ch]pp"):
        for call in thrown(file.read_text(encoding="utf-8")):
            texts = re.findall(r'"((?:[^"\\]|\\.)*)"', CARRIED.sub("", call))
            assert not named.search("".join(texts)), (file, call)
