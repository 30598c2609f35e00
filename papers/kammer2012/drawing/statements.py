# SPDX-License-Identifier: BSD-3-Clause
"""What the paper's text says about its figures, in short, and the claim of the scorecard that tests it."""

from __future__ import annotations

# By the figure's name: statement (a piece of HTML) and claim.
STATEMENTS: dict[str, tuple[tuple[str, str], ...]] = {
    "fig1_setup": (
        ("The stress ratio varies along the interface and is largest far from the edges.", "C2"),
        ("Slip begins by itself at that place.", "C3"),
    ),
    "fig2_static_ratio_mu_k_1.0": (
        ("The higher the ratio before slip, the faster the front, as in experiments.", "C4"),
        ("Speeds agree with measured ones in number, not only in trend.", "E1"),
        ("The front that runs with the imposed shear is clearly the slower of the two.", "C5"),
        ("The front against the shear comes to rest near the place where it began.", "C6"),
        ("Loaded at the top alone, the plate has no slow fronts.", "C7"),
    ),
    "fig3_three_events": (
        ("Fronts that begin by themselves are fast and slow down as the ratio falls toward the edges.", "C8"),
        ("Some fronts outrun the longitudinal wave.", "C9"),
        (
            "Fronts from an edge begin slowly, are fastest where the ratio is largest, and slow down again.",
            "C10",
        ),
        ("One ratio goes with several speeds.", "C12"),
        ("The left-triggered event stays well below the largest speed of the two others.", "C11"),
        ("In (a) the tip, faster than shear waves, runs behind the longitudinal wave.", "C23"),
        ("That wave is a white circle, the outermost zone of (a).", "C25"),
    ),
    "fig4_dynamic_ratio": (
        (
            "Waves ahead of the tip change the ratio that the front meets; over most of its path that ratio "
            "is far below μ<sub>s</sub>.",
            "C13",
        ),
    ),
    "fig5_dynamic_criterion": (
        ("Against this ratio the three events lie closer together than against the static one.", "C14"),
        ("Where it is equal, fronts against the sliding are the faster ones.", "C15"),
        ("Where it is equal, a front that gains speed is faster than one that loses it.", "C16"),
        ("Only against the sliding a front slows down while the ratio at its tip rises.", "C17"),
    ),
    "fig6_energy": (
        (
            "Against the rise of energy at the tip the three events fall onto one curve within a narrow "
            "band.",
            "C18",
        ),
        ("Only points where a front slows down sharply before its end lie outside of it.", "C19"),
    ),
}
