"""Are the forces of a hinge those of a function of its state? By windows of tier small.

1. The forces at the end of a ray beside central differences of W between rays to the states around it, 0.03 apart.
2. The forces at the end of the path of a hinge in its sheet beside those at the end of the straight ray to the same state.

    pip install matplotlib
    kirigami design configs/scenes/steel-1250x1500.toml --restart
    kirigami verify runs/steel-1250x1500 --tier small --sample 4 --out runs/steel-replay
    python docs/results/metals/state_function.py

Solves are kept in runs/metals; state-function.md and state-function.png are written beside this file.
"""

import csv
import json
import math
import subprocess
from pathlib import Path

import matplotlib

matplotlib.use("svg")
import matplotlib.pyplot as plt

PAGE = Path(__file__).parent
STEEL, POLYPROPYLENE = ("s235-1.5mm", 1.5), ("polypropylene-0.8mm", 0.8)
STEP = 0.03
# w_lig over the thickness, alpha_deg, eta_a, eta_s, theta_deg; both are near states of data/s235-1.5mm/spot-check.parquet.
STATES = {
    "compressed and sheared": (26.9 / 1.5, 53, -0.342, -0.312, 14.6),
    "pulled and sheared": (48.3 / 1.5, 51, 0.122, 0.245, 12.1),
}


def solve(material, w_lig, alpha_deg, eta_a, eta_s, theta):
    """W (N mm), F_a, F_s (N) and M (N mm) at the end of the straight ray."""
    name, thickness = material
    window = [name, w_lig, alpha_deg, eta_a, eta_s, theta]
    folder = "runs/metals/" + "_".join(f"{x:.6g}" if isinstance(x, float) else str(x) for x in window)
    answer = Path(f"{folder}.json")
    if not answer.exists():
        options = {
            "--material": f"configs/materials/{name}.toml",
            "--tier": "small",
            "--w-lig": w_lig * thickness,
            "--alpha-deg": alpha_deg,
            "--r-win": 200 * thickness,
            "--kerf": 0.4 * thickness,
            "--eta-a": eta_a,
            "--eta-s": eta_s,
            "--theta-deg": math.degrees(theta),
            "--out": folder,
        }
        command = ["kirigami", "solve", "--json", *(str(x) for option in options.items() for x in option)]
        output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        answer.parent.mkdir(parents=True, exist_ok=True)
        answer.write_text(output)
    end = json.loads(answer.read_text())["samples"][-1]
    return [end[key] for key in ("w", "f_a", "f_s", "m_theta")]


def gradients():
    yield "| state | material | F_a | by W | F_s | by W | M | by W |\n|---|---|---|---|---|---|---|---|"
    for state, (width, alpha, eta_a, eta_s, theta_deg) in STATES.items():
        for material in (STEEL, POLYPROPYLENE):
            at = [eta_a, eta_s, math.radians(theta_deg)]
            _, *forces = solve(material, width, alpha, *at)
            cells = []
            for i, force in enumerate(forces):
                w = [solve(material, width, alpha, *(x + sign * STEP * (i == k) for k, x in enumerate(at)))[0] for sign in (1, -1)]
                arm = (width * material[1], width * material[1], 1.0)[i]
                by_w = (w[0] - w[1]) / (2 * STEP * arm)
                cells += [f"{force:.4g}", f"{by_w:.4g} ({100 * (by_w / force - 1):+.1f} %)"]
            yield f"| {state} | {material[0]} | " + " | ".join(cells) + " |"


def pairs():
    """(hinge, separation, forces at the end of path, ray and law, difference of W); scaled to the thickness of the sheet."""
    sheet = json.load(open("runs/steel-1250x1500/report.json"))["hinges"]
    replay = list(csv.DictReader(open("runs/steel-replay/replay.csv")))
    for hinge in sorted({int(row["hinge"]) for row in replay}):
        end = [row for row in replay if int(row["hinge"]) == hinge][-1]
        x, thickness = sheet[hinge], 0.5
        arms = (1, 1, x["w_lig"])
        path, law = ([float(end[f"{by}_{q}"]) / arm for q, arm in zip(("F_a", "F_s", "M_theta"), arms)] for by in ("fe", "surrogate"))
        w, *forces = solve(STEEL, x["w_lig"] / thickness, x["alpha_deg"], x["eta_a"], x["eta_s"], math.radians(x["theta_deg"]))
        scale = thickness / STEEL[1]
        ray = [force * scale**power / arm for force, power, arm in zip(forces, (2, 2, 3), arms)]
        yield hinge, x["path_separation"], path, ray, law, w * scale**3 / float(end["fe_W"]) - 1


def length(forces):
    return math.sqrt(sum(force**2 for force in forces))


def between(some, others):
    return length(a - b for a, b in zip(some, others))


def main():
    page = ["# The state function", "", "`python docs/results/metals/state_function.py`, windows of tier small.", ""]
    page += ["Forces (N, N mm) at the end of a ray, and as differences of W between rays:", "", *gradients(), ""]
    page += ["Ends of paths in the sheet and of straight rays to them: F_a, F_s, M / w_lig (N), and the norm of their difference over"]
    page += ["that of the forces of the path, those of the ray for *law from ray*.", ""]
    page += ["| hinge | separation | path | ray | law | W, ray | ray from path | law from ray | law from path |"]
    page += ["|---|---|---|---|---|---|---|---|---|"]
    found = list(pairs())
    for hinge, separation, path, ray, law, w in found:
        states = [", ".join(f"{force:.0f}" for force in forces) for forces in (path, ray, law)]
        errors = [f"{100 * between(*two) / length(two[1]):.1f} %" for two in ((ray, path), (law, ray), (law, path))]
        page.append(f"| {hinge} | {separation:.4f} | " + " | ".join([*states, f"{100 * w:+.2f} %", *errors]) + " |")
    sums = [length(between(x[a], x[b]) for x in found) / length(length(x[b]) for x in found) for a, b in ((3, 2), (4, 3), (4, 2))]
    page.append("| all | | | | | | " + " | ".join(f"{100 * x:.1f} %" for x in sums) + " |")
    (PAGE / "state-function.md").write_text("\n".join(page) + "\n")
    print("\n".join(page))

    film = list(csv.DictReader(open("docs/results/detours/detours.csv")))
    figure, axes = plt.subplots(figsize=(7, 4.5))
    pairs_of_film = [(float(x["separation"]), 100 * float(x["forces"])) for x in film]
    axes.loglog(*zip(*pairs_of_film), "o", color="0.6", label="polyester film, detours (detours.csv)")
    steel = [(separation, 100 * between(ray, path) / length(path)) for _, separation, path, ray, *_ in found]
    axes.loglog(*zip(*steel), "s", color="C3", label="steel, paths in the sheet")
    axes.axhline(6, color="k", linewidth=0.8, linestyle="--")
    axes.text(0.5, 6.4, "6 %", ha="right")
    axes.set_xlabel("separation of the path from the straight ray, ligament widths")
    axes.set_ylabel("difference of the forces at the end, %")
    axes.legend()
    figure.tight_layout()
    figure.savefig(PAGE / "state-function.png", dpi=110)


main()
