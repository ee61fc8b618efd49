"""The tables between `<!-- results: NAME -->` and `<!-- end -->` in the pages."""

from __future__ import annotations

from statistics import fmean
from typing import TYPE_CHECKING, Any

from gym_babble.paper.table2 import PAPER_TABLE_II
from gym_babble.study.rates import paper_tally, share
from gym_babble.study.roster import ROSTER
from results.study_blocks import STUDY_BLOCKS
from results.tables import SIZES, interval, markdown, span

if TYPE_CHECKING:
    from collections.abc import Callable

    from results.stores import Stores

OUTCOMES = ("success", "collision", "joint_limit")
DISTANCES = (0, 1, 2, 4, 7, 15)
AGENTS = ("scripted", "oracle")
PANELS = ("halfway", "switched")

PAPER_ROW = ["20,000", *(share(paper_tally()[name]["rate"]) for name in OUTCOMES), "≈ .20"]


def _table1_cells(run: dict[str, Any]) -> list[str]:
    """Success, range of seeds, collision, joint limit, legal."""
    found = run["over_seeds"]
    success, collision, limit = (found[name] for name in OUTCOMES)
    return [
        share(success["mean"]),
        span(success["min"], success["max"]),
        *(share(rate["mean"]) for rate in (collision, limit, found["legal_rate"])),
    ]


def table1_short(stores: Stores) -> str:
    """The README's rows of Table I."""
    rows = [["paper", PAPER_ROW[1], "", *PAPER_ROW[2:]]]
    for title, run in (
        ("Hebb `paper`, body `paper`", "paper"),
        ("Hebb `conjunctive`, body `paper`", "conjunctive"),
        ("Hebb `conjunctive`, after 250 movements", "conjunctive-250"),
        ("Hebb `conjunctive`, body `icub`", "conjunctive-icub"),
    ):
        rows.append([title, *_table1_cells(stores["table1"][run])])
    return markdown(["", "success", "seeds", "collision", "joint limit", "legal"], rows)


def table1(stores: Stores) -> str:
    """Table I of both variants and bodies."""
    rows = [["the paper", "", *PAPER_ROW[:2], "", *PAPER_ROW[2:]]]
    runs = ("paper", "paper-icub", "conjunctive", "conjunctive-250")
    for run in (*runs, "conjunctive-icub", "conjunctive-icub-250"):
        found = stores["table1"][run]
        about = [f"`{found['variant']}`", found["config"], f"{found['movements']:,}"]
        rows.append([*about, *_table1_cells(found)])
    heads = ["agent", "body", "movements", "success", "seeds", "collision", "joint limit", "legal"]
    return markdown(heads, rows)


def fig4(stores: Stores) -> str:
    """How many movements of Fig. 4 reach the target, beside agents that learnt nothing."""
    found = stores["fig4"]["paper"]
    titles = {
        "agent": "Hebb `paper`",
        "straight": "straight movement, b1 = ½",
        "random": "random b1",
        "scripted": "curve to the shoulder",
    }
    rows = [
        [title, *(f"{found['reached'][name][panel]} of {found['cases']}" for panel in PANELS)]
        for name, title in titles.items()
    ]
    return markdown(["agent", "obstacle halfway", "switched"], rows)


def sensitivity(stores: Stores) -> str:
    """Table I with one number changed."""
    rows = [
        [row["change"], *(share(row[name]) for name in (*OUTCOMES, "legal_rate"))]
        for row in stores["sensitivity"]["rows"]
    ]
    return markdown(["change", "success", "collision", "joint limit", "legal"], rows)


TESTS = {"table2": "Table II's grid", "palm_side": "region `palm_side`", "full": "region `full`"}


def vote(stores: Stores) -> str:
    """What can be had from the obstacle's direction alone."""
    titles = {
        "constant": ("the best constant", "nothing"),
        "vote_eye": ("vote", "eye"),
        "hebb": ("Hebb `paper`", "obstacle"),
        "vote_obstacle": ("vote", "obstacle"),
        "vote_obstacle_eye": ("vote", "obstacle and eye"),
        "side": ("one curve to the side that succeeds", "the side"),
        "any": ("any b1 that succeeds", ""),
    }
    rows = []
    for name, title in titles.items():
        found = stores["vote"]["rows"][name]
        rows.append([*title, share(found["success"]), ", ".join(map(share, found["by_seed"]))])
    return markdown(["choice of b1", "sees", "success", "by seed"], rows)


READOUTS = {"mean": "mean of the map, Eq. 4", "peak": "around the strongest neuron"}


def readouts(stores: Stores) -> str:
    """Which rule, map and readout come how near to what the obstacle's direction allows."""
    titles = {
        "obstacle, Eq. 7": "Eq. 7, 21 × 21 over ± 60°",
        "obstacle, Hebb": "Hebb, η = 1, 21 × 21 over ± 60°",
        "fine obstacle, Hebb": "Hebb, η = 0.1, 41 × 41 over ± 40°",
    }
    rows = [
        [
            titles[row["network"]],
            READOUTS[row["readout"]],
            share(row["success"]),
            ", ".join(map(share, row["by_seed"])),
        ]
        for row in (*stores["readouts"]["paper"], *stores["readouts"]["fine"])
        if row["network"] in titles and row["movements"] == 20_000
    ]
    return markdown(["rule and map", "readout", "success", "by seed"], rows)


def inputs(stores: Stores) -> str:
    """Which input, rule and readout let an agent reach, after few and after many movements."""
    found = [row for run in ("paper", "icub") for row in stores["readouts"][run]]
    rates = {
        (row["network"], row["readout"], row["body"], row["movements"]): row["by_seed"]
        for row in found
    }
    columns = [(body, n) for body in ("paper", "icub") for n in (250, 20_000)]
    rows = []
    for sees in ("obstacle", "eye", "obstacle x eye"):
        for rule in ("Eq. 7", "Hebb"):
            for readout, title in READOUTS.items():
                cells = [rates.get((f"{sees}, {rule}", readout, *column)) for column in columns]
                numbers = [_with_span(by_seed) if by_seed else "–" for by_seed in cells]
                rows.append([sees.replace("x", "×"), rule, title, *numbers])
    heads = [f"`{body}`, {n:,}" for body, n in columns]
    return markdown(["input", "rule", "readout", *heads], rows)


def _with_span(rates: list[float]) -> str:
    return f"{share(fmean(rates))} ({span(min(rates), max(rates))})"


def changed_body(stores: Stores) -> str:
    """How far agents fall in a changed body, and after how much learning they are back."""
    rates: dict[tuple[str, str], dict[int | None, list[float]]] = {}
    for row in (row for run in stores["changed_body"].values() for row in run):
        which = row["agent"], row["change"]
        rates.setdefault(which, {})[row["movements"]] = row["by_seed"]
    rows = []
    for which, found in rates.items():
        at_once, alone = _with_span(found.pop(0)), _with_span(found.pop(None))
        later = [f"{share(fmean(seeds))} after {budget:,}" for budget, seeds in found.items()]
        rows.append([*which, at_once, ", ".join(later), alone])
    return markdown(["agent", "change", "at once", "after learning on", "learnt there alone"], rows)


def periods(stores: Stores) -> str:
    """What the time between two applications of the rule decides."""
    rows = [
        [
            f"{row['period_s']:g} s" if row["period_s"] else "once",
            *(share(rate) for rate in row["reach"]),
            *(", ".join(f"{ep:.1f}" for ep in hand) for hand in row["hands"]),
            *(f"{row['weights_by_distance'][d]:.3f}".replace("-", "−") for d in DISTANCES),
        ]
        for row in stores["periods"]["rows"]
    ]
    weights = [f"weight at {DISTANCES[0]}", *map(str, DISTANCES[1:])]
    heads = ["period", "reach, 2.4 cm", "6 cm", "EPs, 2.4 cm [°]", "6 cm [°]", *weights]
    return markdown(heads, rows)


def table2_short(stores: Stores) -> str:
    """The README's rows of Table II: both sizes in a cell."""
    paper = [" / ".join(share(PAPER_TABLE_II[s][f]) for s in SIZES) for f in ("reach", "held")]
    rows = [["paper, small / big, 144 tests each", *paper]]
    sizes = stores["table2"]["paper"]["sizes"]
    for protocol, title in TESTS.items():
        means = [size["tests"][protocol]["over_seeds"] for size in sizes]
        cells = [" / ".join(share(mean[f]["mean"]) for mean in means) for f in ("reach", "held")]
        rows.append([f"ours, 2.4 / 6 cm, {title}", *cells])
    return markdown(["", "any part touches", "grasped"], rows)


def table2(stores: Stores) -> str:
    """Reaching and grasping in the tests of Table II and in the regions."""
    rows = [
        ["paper", size, "144", share(known["reach"]), "", share(known["held"])]
        for size, known in PAPER_TABLE_II.items()
    ]
    for protocol, title in TESTS.items():
        for size in stores["table2"]["paper"]["sizes"]:
            tests = size["tests"][protocol]
            number = sum(seed["cases"] for seed in tests["by_seed"])
            rates = [tests["over_seeds"][fact] for fact in ("reach", "palm_reach", "held")]
            cells = [f"{share(rate['mean'])} ({span(rate['min'], rate['max'])})" for rate in rates]
            rows.append([title, f"{100 * size['diameter']:g} cm", f"{number:,}", *cells])
    heads = ["tests", "size", "number", "any part touches", "palm touches", "grasped"]
    return markdown(heads, rows)


def hands(stores: Stores) -> str:
    """The learned equilibrium points beside the paper's."""
    sizes = stores["table2"]["paper"]["sizes"]
    rows = []
    for digit, name in (("thumb", "thumb"), ("finger", "index")):
        learned, ideal = [f"{name}: learned EP ± spread"], [f"{name}: ideal, and babbled"]
        for known, size in zip(PAPER_TABLE_II.values(), sizes, strict=True):
            theirs, ours = known[digit], size["hand"][digit]
            learned.append(f"{theirs['mean']:.2f} ± {theirs['spread']:.3f}")
            learned.append(f"{ours['mean']:.2f} ± {ours['spread']:.2f}")
            ideal.append(f"{theirs['ideal']:.0f}")
            ideal.append(f"{ours['babbled_mean']:.2f} ± {ours['babbled_spread']:.2f}")
        rows += [learned, ideal]
    heads = ["", "paper, small", "ours, 2.4 cm", "paper, big", "ours, 6 cm"]
    return markdown(heads, rows)


def holding(stores: Stores) -> str:
    """The reflex alone, in Table II's run."""
    rows = [
        [
            f"{100 * rate['diameter']:g}",
            f"{rate['held']} of {rate['trials']}",
            interval(rate),
            f"{rate['penetration_mm']:.1f}",
        ]
        for rate in stores["table2"]["paper"]["hold"]
    ]
    return markdown(["diameter [cm]", "held", "95 %", "deepest [mm]"], rows)


def sizes(stores: Stores) -> str:
    """Which sizes the hand holds, and what the fovea sees of them."""
    rows = []
    for found in stores["sizes"]["tree"]:
        thumb, finger = found["flexion_deg"]
        rows.append(
            [
                f"{100 * found['diameter']:g}",
                share(found["rate"]),
                interval(found),
                f"{thumb:.0f}, {finger:.0f}",
                f"{found['edges']} of 441",
            ]
        )
    heads = ["diameter [cm]", "held", "95 %", "flexion thumb, finger [°]", "edges in the fovea"]
    return markdown(heads, rows)


def engines(stores: Stores) -> str:
    """Balls held, of 100, by both engines and by independent fingers."""
    runs = {
        title: {rate["diameter"]: rate for rate in stores["sizes"][run]}
        for run, title in (
            ("tree", "`tree`"),
            ("independent", "`tree`, independent fingers"),
            ("rapier", "`rapier`"),
        )
    }
    diameters = [diameter for diameter in runs["`tree`"] if diameter <= 0.08]
    rows = []
    for title, rates in runs.items():
        found = [rates.get(diameter) for diameter in diameters]
        rows.append([title, *(str(rate["held"]) if rate else "–" for rate in found)])
        deepest = [f"{rate['penetration_mm']:.2f}" if rate else "–" for rate in found]
        rows.append(["deepest [mm]", *deepest])
    table = markdown(["diameter [cm]", *(f"{100 * d:g}" for d in diameters)], rows)
    return "".join(f"  {line}\n" for line in table.splitlines())


def sides(stores: Stores) -> str:
    """Success by the side on which the hand starts."""
    found = stores["sides"]["scripted"]
    rows = [
        [
            f"{row['low']:.0f} to {row['high']:.0f}".replace("-", "−") if "low" in row else "all",
            f"{row['cases']:,}",
            share(row["palm_reach"]),
            share(row["held"]),
        ]
        for row in (*found["rows"], found["all"])
    ]
    heads = ["object's direction minus start shoulder [°]", "cases", "palm touches", "grasped"]
    return markdown(heads, rows)


def interference(stores: Stores) -> str:
    """What small objects, big ones, and both teach."""
    rows = []
    for row in stores["interference"]["rows"]:
        cells = [
            f"{mean:.2f} ± {spread:.2f}".replace("-", "−")
            for mean, spread in zip(row["mean"], row["spread"], strict=True)
        ]
        cells += [
            ", ".join(f"{ep:.1f}" for ep in row[name]) if row[name] else "–, –"
            for name in ("babbled", "in_hand")
        ]
        rows.append([row["babbled_with"], f"{100 * row['diameter']:g} cm", *cells])
    heads = ["babbled with", "object", "gap [cm]", "thumb EP [°]", "finger EP [°]", "babbled"]
    return markdown([*heads, "recalled in the hand"], rows)


def basin(stores: Stores) -> str:
    """Where along the palm a ball must lie to be held."""
    found: dict[float, list[dict[str, Any]]] = {}
    for row in stores["basin"]["elbow"]:
        found.setdefault(row["diameter_cm"], []).append(row)
    rows = []
    for size, of_size in found.items():
        never = [row["wrist_cm"] for row in of_size if row["held"] == 0]
        always = [row["wrist_cm"] for row in of_size if row["held"] == 1]
        spans = [f"{min(at)}–{max(at)}" if at else "–" for at in (never, always)]
        rows.append([f"{size:g}", *spans, str(len(of_size) - len(never) - len(always))])
    return markdown(
        ["diameter [cm]", "never held [cm]", "always held [cm]", "places between"], rows
    )


def chain(stores: Stores) -> str:
    """How often the chain holds objects of each size: mean and worst of the seeds."""
    found: dict[tuple[Any, ...], dict[float, list[dict[str, Any]]]] = {}
    for run in stores["chain"].values():
        for row in run:
            learnt = (row["config"], row["region"], row["learnt"], row["practised"])
            found.setdefault(learnt, {}).setdefault(row["diameter_cm"], []).append(row)
    sizes = sorted({size for of in found.values() for size in of})
    rows = []
    for (config, region, learnt, practised), of_size in found.items():
        cells = [f"`{config}`", f"`{region}`", f"{learnt:,}", f"{practised:,}"]
        some = next(iter(of_size.values()))
        steps, seconds = (
            fmean(row[name] for row in some) for name in ("control_steps", "processor_seconds")
        )
        cells += [f"{steps:,.0f}", f"{seconds:.0f} s"]
        for size in sizes:
            held = [row["kept"] for row in of_size.get(size, ())]
            cells.append(f"{share(fmean(held))} ({share(min(held))})" if held else "")
        rows.append(cells)
    heads = ["body", "region", "babbles kept", "trials", "control steps", "CPU"]
    return markdown([*heads, *(f"{size:g} cm" for size in sizes)], rows)


def movements(stores: Stores) -> str:
    """How the chain's movements change while it learns."""
    rows = []
    for row in stores["movements"]["rows"]:
        cells = [f"{row['babbles']:,}", share(row["touched"]), f"{row['units']:.2f}"]
        cells += [f"{row['straightness']:.2f}", share(row["palm_first"]), f"{row['off_deg']:.1f}"]
        cells += [f"{row['closings']:.2f}", f"{row['seconds_to_hold']:.1f}"]
        rows.append([*cells, *map(share, row["held"].values())])
    heads = ["babbles", "touched", "units", "straightness", "palm first", "off [°]", "closings"]
    sizes = [f"held, {size}" for size in stores["movements"]["rows"][0]["held"]]
    return markdown([*heads, "to hold [s]", *sizes], rows)


def carry(stores: Stores) -> str:
    """How often the chain holds objects at their goals."""
    found: dict[float, list[dict[str, Any]]] = {}
    for row in stores["carry"]["chain"]:
        found.setdefault(row["diameter_cm"], []).append(row)
    rows = []
    for size, of_size in found.items():
        carried = [row["carried"] for row in of_size]
        rows.append([f"{size:g}", f"{sum(row['cases'] for row in of_size):,}"])
        rows[-1] += [share(fmean(carried)), span(min(carried), max(carried))]
        rows[-1] += [share(fmean(row["held"] for row in of_size))]
        rows[-1] += [f"{fmean(row['distance_cm'] for row in of_size):.2f}"]
    heads = ["diameter [cm]", "cases", "held within 2 cm of the goal", "seeds", "held anywhere"]
    return markdown([*heads, "distance of held ones [cm]"], rows)


def roster(_: Stores) -> str:
    """The agents that a study can name."""
    rows = []
    for name, agent in ROSTER.items():
        for task, place in agent.tasks.items():
            budget = f"{place.budget:,}" if place.budget else "–"
            knows = ", ".join(place.knows) or "–"
            rows.append([f"`{name}`", agent.title, task, place.sees, knows, budget])
    heads = ["name", "agent", "task", "sees", "knows beforehand", "control steps"]
    return markdown(heads, rows)


def solved(stores: Stores) -> str:
    """What the scripted agent and the oracle solve of the default cases."""
    rows = [
        [f"`{row['id']}`", row["control"], *(share(row[who] / row["cases"]) for who in AGENTS)]
        for found in stores["solved"].values()
        for row in found
    ]
    return markdown(["id", "control", *(f"`{who.title()}`" for who in AGENTS)], rows)


def tuning(stores: Stores) -> str:
    """The searches for settings."""
    rows = []
    for found in stores["tuning"]:
        trials, plan = found["trials"], found["plan"]
        scores = [fmean(trial["success"]) for trial in trials]
        rows.append(
            [
                f"{found['algorithm'].upper()}, `{found['env_id']}`",
                f"{plan['steps']:,}",
                str(len(plan["seeds"])),
                str(plan["cases"]),
                str(len(trials)),
                f"{sum(trial['cpu_seconds'] for trial in trials):,.0f}",
                share(scores[0]),
                share(max(scores)),
            ]
        )
    heads = ["algorithm", "movements", "seeds", "cases", "trials", "CPU s", "first", "best"]
    return markdown(heads, rows)


BLOCKS: dict[str, Callable[[Stores], str]] = {
    block.__name__: block
    for block in (
        *(table1_short, table1, fig4, sensitivity, vote, readouts, inputs, changed_body),
        *(table2_short, table2, hands, holding),
        *(
            sizes,
            engines,
            sides,
            interference,
            periods,
            basin,
            chain,
            movements,
            carry,
            solved,
            tuning,
            roster,
        ),
        *STUDY_BLOCKS,
    )
}
"""The tables by name."""
