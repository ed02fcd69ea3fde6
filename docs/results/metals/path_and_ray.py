"""Forces at the ends of the paths of a sheet, and at the ends of rays to the same states.

    python path_and_ray.py replay.csv PREFIX HINGE,HINGE,...

replay.csv is written by `kirigami verify RUN --sample N`, PREFIX + HINGE + .json by `kirigami solve --json`. Norms of (F_a, F_s, M / w_lig).
"""

import csv
import json
import math
import sys
from collections import defaultdict

replay, prefix, hinges = sys.argv[1:4]
steps = defaultdict(list)
for row in csv.DictReader(open(replay)):
    steps[row["hinge"]].append({key: float(value) for key, value in row.items()})


def forces(w_lig, f_a, f_s, moment):
    return (f_a, f_s, moment / w_lig)


def squared(one, other=(0.0, 0.0, 0.0)):
    return sum((x - y) ** 2 for x, y in zip(one, other))


total = defaultdict(float)
print("| hinge | apart, w_lig | (F_a, F_s, M / w_lig) on the path, N | on the ray, N | by law, N | ray against path | law against ray | W, ray against path |")
print("|---|---|---|---|---|---|---|---|")
for hinge in hinges.split(","):
    path = steps[hinge]
    end = path[-1]
    w_lig = end["w_lig_mm"]
    of_ray = json.load(open(f"{prefix}{hinge}.json"))["samples"]
    apart = 0.0
    states = [(s["a"] / w_lig, s["s"] / w_lig, s["theta"]) for s in of_ray]
    for row in path:
        theta = math.radians(row["theta_deg"])
        after = next((k for k, s in enumerate(states) if s[2] >= theta), len(states) - 1)
        before = states[after - 1] if after else (0.0, 0.0, 0.0)
        share = (theta - before[2]) / (states[after][2] - before[2])
        at = [before[i] + share * (states[after][i] - before[i]) for i in (0, 1)]
        apart = max(apart, math.hypot(row["eta_a"] - at[0], row["eta_s"] - at[1]))
    last = of_ray[-1]
    ray = forces(w_lig, last["f_a"], last["f_s"], last["m_theta"])
    on_path, law = (forces(w_lig, *(end[f"{of}_{name}"] for name in ("F_a", "F_s", "M_theta"))) for of in ("fe", "surrogate"))
    show = lambda values: ", ".join(f"{value:.0f}" for value in values)
    differ = lambda one, other: 100 * math.sqrt(squared(one, other) / squared(other))
    print(f"| {hinge} | {apart:.3f} | {show(on_path)} | {show(ray)} | {show(law)} | {differ(ray, on_path):.1f} % | {differ(law, ray):.1f} % | {100 * (last['w'] / end['fe_W'] - 1):.1f} % |")
    for name, one, other in (("ray against path", ray, on_path), ("law against path", law, on_path), ("law against ray", law, ray)):
        total[name] += squared(one, other)
        total[name + " of"] += squared(other)
for name in ("ray against path", "law against path", "law against ray"):
    print(f"{name}, over all: {100 * math.sqrt(total[name] / total[name + ' of']):.1f} %")
