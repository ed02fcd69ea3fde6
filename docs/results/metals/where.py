"""Where the errors of the weights of steel are: by training and unseen rays, size of state and shear; states inside the training domain.

    pip install polars
    python docs/results/metals/where.py
"""

import io, json, subprocess
import polars as pl

DATA, FORCES = "data/s235-1.5mm/", ["F_a", "F_s", "M_theta"]

def states(file):  # the rows of a database inside the training domain, with the errors of the law
    rows = pl.read_parquet(file)
    rows.select("w_lig", "alpha", "a", "s", "theta").write_csv("runs/states.csv")
    evaluate = ["kirigami", "surrogate", "eval", DATA + "weights.safetensors", "runs/states.csv"]
    law = pl.read_csv(io.BytesIO(subprocess.run(evaluate, capture_output=True, check=True).stdout))
    errors = [(law[q] - rows[q]).alias("e_" + q) for q in ["W", *FORCES]]
    return rows.with_columns(errors, inside=law["inside"]).filter("inside")

def line(name, rows):
    rms = [100 * (rows["e_" + q].pow(2).mean() / rows[q].pow(2).mean()) ** 0.5 for q in ["W", *FORCES]]
    print(f"| {name} | {rows['job'].n_unique()} | {rows.height} |", " | ".join(f"{x:.1f} %" for x in rms), "|")

rays, spot = states(DATA + "hinges.parquet"), states(DATA + "spot-check.parquet")
trained = pl.col("job").is_in(json.load(open(DATA + "hinges.json"))["split"]["training"])
unseen, size = rays.filter(~trained), pl.col("theta").degrees()
shear = (pl.col("s") / pl.col("w_lig")).abs()
line("training rays", rays.filter(trained))
line("unseen rays", unseen)
for low, high in [(-10, 0.5), (0.5, 2), (2, 5), (5, 20), (20, 90)]:
    line(f"unseen, {low} to {high} deg", unseen.filter((size >= low) & (size < high)))
line("unseen, sheared by less than 0.1", unseen.filter(shear < 0.1))
line("unseen, sheared by 0.1 or more", unseen.filter(shear >= 0.1))
line("spot check", spot)
line("spot check, sheared by less than 0.1", spot.filter(shear < 0.1))
line("spot check, sheared by 0.1 or more", spot.filter(shear >= 0.1))
scale = rays["F_a"].pow(2).mean() ** 0.5
print(f"F_a over the rays, root mean square: {scale:.0f} N at 1.5 mm, {scale / 9:.0f} N at 0.5 mm")
squares = sum(spot["e_" + q] ** 2 / (spot[q] ** 2).mean() for q in FORCES)
by_ray = spot.with_columns(squares=squares).group_by("job").agg(pl.col("squares").sum())["squares"].sort(descending=True)
print(f"spot check: {100 * by_ray[:3].sum() / by_ray.sum():.0f} % of the squared error of the forces is on 3 of {by_ray.len()} rays")
