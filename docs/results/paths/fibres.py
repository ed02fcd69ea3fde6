"""A hinge as fibres across its ligament, with memory: is it truer than a function of the state?

Run `forces_by_path` for a material first, and `kirigami dataset export data/MATERIAL/visited.parquet --out visited.csv`; then
`python fibres.py FOLDER_OF_SOLVES visited.csv`. Needs numpy and scipy. Strains: eta_a beyond the free turn, eta_s, theta; forces
F_a w_lig, F_s w_lig, M_theta. The fibres are fitted to the rays alone and tested on the paths in the sheets.
"""

import csv
import glob
import json
import sys

import numpy as np
from scipy.optimize import least_squares

FIBRES = 6
STEPS = 2  # between two states of a ray
NAMES = ["length", "gradient", "stiffness", "shear stiffness", "shear weight", "yield", "hardening", "strain of hardening", "slope"]
NAMES += ["free turn 2", "free turn 3", "middle", "curvature"]
y, weight = np.polynomial.legendre.leggauss(FIBRES)
y, weight = 0.5 + 0.5 * y, 0.5 * weight


def states(rows, width, names):
    strain = [[float(r["a"]) / width, float(r["s"]) / width, float(r["theta"])] for r in rows]
    force = [[float(r[names[0]]) * width, float(r[names[1]]) * width, float(r[names[2]])] for r in rows]
    return np.array(strain), np.array(force), width


def solved_rays(folder):
    for job in glob.glob(f"{folder}/*/*/job.json"):
        with open(job) as text, open(job.replace("job.json", "rows.csv")) as rows:
            width = json.load(text)["problem"]["ray"]["design"]["w_lig"]
            yield states(list(csv.DictReader(rows)), width, ["f_a", "f_s", "m_theta"])


def visited_paths(file):
    paths = {}
    for row in csv.DictReader(open(file)):
        paths.setdefault(row["job"], []).append(row)
    return [states(rows, float(rows[0]["w_lig"]), ["F_a", "F_s", "M_theta"]) for rows in paths.values()]


def refined(paths, steps):
    """The strains between the states, and the places of the states among them."""
    fine, places = [], []
    for strain, _, _ in paths:
        knots = np.vstack([np.zeros(3), strain])
        at = np.linspace(0, len(strain), len(strain) * steps + 1)
        fine.append(np.stack([np.interp(at, np.arange(len(knots)), knots[:, k]) for k in range(3)], -1))
        places.append(np.arange(1, len(knots)) * steps)
    longest = max(map(len, fine))
    return np.array([np.vstack([one, np.repeat(one[-1:], longest - len(one), 0)]) for one in fine]), places


def forces(strain, x):
    """Forces along strains, by backward Euler: each step minimises the energy and the work of flow of every fibre."""
    length, stiff, shear_stiff, shear, first, rise, scale, slope = np.exp([x[i] for i in (0, 2, 3, 4, 5, 6, 7, 8)])
    hardening = lambda p: first + rise * (1 - np.exp(-p / scale)) + slope * p
    lengths = length * np.exp(2 * x[1] * (y - 0.5) + 4 * x[12] * (y - 0.5) ** 2)
    theta, size = strain[..., 2], abs(strain[..., 2])
    axial = (strain[..., 0] - 0.5 * theta - x[9] * theta * size - x[10] * theta**3)[..., None] - (y - x[11]) * theta[..., None]
    by_theta = -((y - x[11]) + (0.5 + 2 * x[9] * size + 3 * x[10] * size**2)[..., None]) / lengths
    both = np.stack([axial / lengths, strain[..., 1][..., None] / lengths], -1)
    stiffness, norm = np.array([stiff, shear_stiff]), np.array([1.0, shear])
    plastic, flow, out = np.zeros(both[:, 0].shape), np.zeros(both[:, 0, :, 0].shape), np.zeros(strain.shape)
    for k in range(1, strain.shape[1]):
        trial = stiffness * (both[:, k] - plastic)
        yields = np.sqrt((trial**2 * norm).sum(-1)) > hardening(flow)
        low, high = np.zeros_like(flow), np.where(yields, 0.3, 0.0)
        returned = lambda more: trial / (1 + stiffness * norm * (more / hardening(flow + more))[..., None])
        for _ in range(32):
            more = 0.5 * (low + high)
            above = np.sqrt((returned(more) ** 2 * norm).sum(-1)) > hardening(flow + more)
            low, high = np.where(above, more, low), np.where(above, high, more)
        more = np.where(yields, 0.5 * (low + high), 0.0)
        stress = returned(more)
        plastic, flow = both[:, k] - stress / stiffness, flow + more
        pull, side = stress[..., 0] * weight, stress[..., 1] * weight
        out[:, k] = np.stack([(pull / lengths).sum(-1), (side / lengths).sum(-1), (pull * by_theta[:, k]).sum(-1)], -1)
    return out


def main(folder, file):
    rays, paths = list(solved_rays(folder)), visited_paths(file)
    fine, places = refined(rays, STEPS)
    scale = np.sqrt(np.mean(np.concatenate([force for _, force, _ in paths]) ** 2, 0))
    scale = np.maximum(scale, [0.02 * scale[2], 0.02 * scale[2], 0])

    def residual(x):
        found = forces(fine, x)
        return np.concatenate([((found[i][places[i]] - rays[i][1]) / scale).ravel() for i in range(len(rays))])

    moment = max(abs(force[:, 2]).max() for _, force, _ in rays)
    stiff = 12 * np.median([force[0, 2] / strain[0, 2] for strain, force, _ in rays])
    start = [0, 0, np.log(stiff), np.log(stiff / 3), np.log(3), np.log(2 * moment), np.log(1.5 * moment), np.log(0.1), np.log(2 * moment)]
    start = np.array([*start, 0.16, 0, 0.5, 0])
    reach = np.array([1.5, 1, 2, 2, 1.5, 2, 3, 2.5, 4, 0.3, 0.3, 0.2, 1.0])
    fit = least_squares(
        residual, start, bounds=(start - reach, start + reach), loss="soft_l1", f_scale=0.2, max_nfev=120, x_scale=reach, diff_step=1e-4
    )
    print(len(rays), "rays;", dict(zip(NAMES, np.round(fit.x, 3).tolist())))
    fine, places = refined(paths, 30)
    found = forces(fine, fit.x)
    ends = np.array([[found[i][places[i]][-1], paths[i][1][-1]] for i in range(len(paths))])
    error = 100 * np.sqrt(((ends[:, 0] - ends[:, 1]) ** 2).mean(0) / (ends[:, 1] ** 2).mean(0))
    print("fibres against path, at its end: F_a, F_s, M %", np.round(error, 1))


main(*sys.argv[1:])
