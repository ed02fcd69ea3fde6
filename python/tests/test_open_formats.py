"""Files that others read without the package: the reader of the examples, databases, run folders; and the stubs."""

import json
import re
import runpy
import subprocess
import sys

import kirigami as kg
import numpy as np
import pytest
from conftest import DATA, REPOSITORY, SCENES


def test_the_reader_of_the_examples_agrees_with_the_kernel(film):
    reader = runpy.run_path(REPOSITORY / "python" / "examples" / "read_weights.py")
    tensors = reader["read_safetensors"](DATA / "pet-0.5mm" / "medium.safetensors")
    card = json.loads((DATA / "pet-0.5mm" / "medium.json").read_text())
    random = np.random.default_rng(5)
    states = random.uniform([-0.3, -0.3, 0.1], [0.3, 0.3, 0.6], (200, 3))
    widths, angles = random.uniform(8.0, 24.0, 200), random.uniform(0.8, 2.2, 200)
    at = film(states, widths, angles)
    assert at.inside.sum() > 100
    hinges = [column[at.inside] for column in (*states.T, widths, angles)]
    np.testing.assert_allclose(reader["energy"](tensors, *hinges), at.energy[at.inside], rtol=1e-12)
    expected = np.column_stack([at.damage, at.damage_peak])[at.inside]
    np.testing.assert_allclose(reader["damage"](tensors, card, *hinges), expected, rtol=1e-12)


def test_the_code_of_the_docs_page_runs(monkeypatch):
    pytest.importorskip("jax")
    page = (REPOSITORY / "docs" / "PYTHON.md").read_text()
    monkeypatch.chdir(REPOSITORY)
    names = {}
    for code in re.findall(r"```python\n(.*?)```", page, re.DOTALL):
        if "import torch" in code:
            continue
        exec(code, names)
    assert names["ended"] == "completed" and np.isfinite(names["by_thickness"])


def test_databases_are_read_by_polars_and_pandas():
    path = DATA / "pet-0.5mm" / "spot-check.parquet"
    polars, pandas = kg.read_database(path), kg.read_database(path, "pandas")
    assert polars.shape == pandas.shape and polars.columns == list(pandas.columns)
    np.testing.assert_array_equal(polars["W"].to_numpy(), pandas["W"].to_numpy())
    with pytest.raises(ValueError, match='`library` is "excel"'):
        kg.read_database(path, "excel")


@pytest.mark.parametrize("path", sorted(DATA.glob("*/*.parquet")), ids=lambda path: f"{path.parent.name}-{path.stem}")
def test_the_shipped_databases_are_filtered_by_number_and_by_text(path):
    pandas = pytest.importorskip("pandas")
    parquet = pytest.importorskip("pyarrow.parquet")
    duckdb = pytest.importorskip("duckdb")
    whole = pandas.read_parquet(path)
    # States on the paths of sheets do not open as far as rays: half of the states of each file.
    tier, theta = whole.tier.iloc[0], float(whole.theta.median())
    for column, sign, value, expected in [
        ("theta", ">", theta, (whole.theta > theta).sum()),
        ("tier", "==", tier, (whole.tier == tier).sum()),
    ]:
        assert expected > 0
        assert len(pandas.read_parquet(path, filters=[(column, sign, value)])) == expected
        assert parquet.read_table(path, filters=[(column, sign, value)]).num_rows == expected
        query = f"select count(*) from read_parquet(?) where {column} {sign} ?"
        assert duckdb.execute(query, [str(path), value]).fetchone() == (expected,)
    in_order = parquet.read_table(path).sort_by("theta")["theta"].to_numpy()
    np.testing.assert_array_equal(in_order, np.sort(whole.theta))
    assert "string_view" not in {str(column.type) for column in parquet.read_schema(path)}


def test_a_run_folder_is_read_back(program, tmp_path):
    keys = (SCENES / "pin-7x7.toml").read_text()
    scene = tmp_path / "pins.toml"
    keys = re.sub(r'^material = "\.\.', f'material = "{SCENES.parent}', keys, flags=re.MULTILINE)
    keys = re.sub(r"^output = .*$", 'output = "run"', keys, flags=re.MULTILINE)
    scene.write_text(re.sub(r"^steps = .*$", "steps = 5", keys, flags=re.MULTILINE))
    subprocess.run([program, "design", scene, "--quiet"], check=True, capture_output=True)
    run = kg.Run.read(tmp_path / "run")
    assert [record["step"] for record in run.history] == list(range(6))
    assert run.report
    problem = kg.Problem(run.folder)
    np.testing.assert_array_equal(problem.stored(run.folder / "state.json"), run.design)
    loss, _ = problem.loss_and_gradient(run.design)
    assert loss == pytest.approx(min(record["loss"] for record in run.history), rel=1e-6)
    x, _, history = kg.Problem(scene).design()
    np.testing.assert_allclose(x, run.design, rtol=1e-12)
    assert history[-1]["loss"] == pytest.approx(run.history[-1]["loss"], rel=1e-12)
    with pytest.raises(FileNotFoundError, match="not the folder of a run"):
        kg.Run.read(tmp_path)


def test_the_stubs_are_those_of_the_module(tmp_path):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy.stubtest", "kirigami._kirigami"]
    # Elsewhere than next to the sources, which have no compiled part.
    checked = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert checked.returncode == 0, checked.stdout


def test_every_public_item_has_a_docstring():
    for name in kg.__all__:
        item = getattr(kg, name)
        assert item.__doc__, name
        members = [member for member in vars(item) if not member.startswith("_")] if isinstance(item, type) else []
        for member in members:
            assert getattr(item, member).__doc__, f"{name}.{member}"


def test_pictures(film, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    from kirigami import plot
    from matplotlib import pyplot

    problem = kg.Problem(SCENES / "pet-3x3.toml")
    path = problem.equilibrium(problem.start)
    rotation = path.configuration[-1, :, 2]
    drawn = [plot.sheet(path, rotation, "rotation (rad)"), plot.sheet(path.sheet), plot.path(path), plot.rotation(film, [5.0, 25.0])[0]]
    for number, axes in enumerate(drawn):
        axes.figure.savefig(tmp_path / f"{number}.png")
        assert axes.has_data()
    pyplot.close("all")
