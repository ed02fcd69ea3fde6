"""Prepared problems from Python: states, paths, gradients against central differences, warm starts, batches, errors."""

import json
import multiprocessing
import pickle
import signal
import subprocess
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import kirigami as kg
import numpy as np
import pytest
from conftest import SCENES, slope

RANDOM = np.random.default_rng(7)


@pytest.fixture(scope="module", params=["pet-3x3", "a4-plate", "linear-7x7"])
def problem(request):
    """Dead loads on a clamped film; a hanging, heavy plate with a prescribed stroke; springs."""
    return kg.Problem(SCENES / f"{request.param}.toml")


@pytest.fixture(scope="module")
def film_problem():
    return kg.Problem(SCENES / "pet-3x3.toml")


def test_shapes(problem):
    m, n = problem.panels
    panels, hinges = m * n, 2 * m * n - m - n
    x = problem.start
    assert x.shape == (problem.size,)
    blocks = problem.blocks
    assert blocks["omega"].stop - blocks["omega"].start == hinges and blocks["opening"].stop == problem.size
    state = problem.solve(x)
    assert state.corners.shape == (panels, 4, 2)
    assert state.reactions.shape == state.configuration.shape == problem.loads.shape == (panels, 3)
    assert state.deformation.shape == (hinges, 3)
    path = problem.equilibrium(x)
    steps = len(path)
    assert path.corners.shape == (steps, panels, 4, 2)
    assert path.deformation.shape == (steps, hinges, 3)
    assert path.energy.shape == path.damage.shape == path.inside.shape == (steps, hinges)
    assert len(path.status) == path.load_factor.size == steps
    np.testing.assert_allclose(path.corners[-1], state.corners, atol=1e-6)
    np.testing.assert_allclose(state.sheet.boundaries(state.configuration), state.corners, atol=1e-12)
    np.testing.assert_allclose(path.reactions, state.reactions, atol=1e-6 * np.abs(state.reactions).max())


def test_the_gradient_of_the_objective(problem):
    x = problem.start + 0.05 * RANDOM.standard_normal(problem.size)
    _, gradient = problem.loss_and_gradient(x, warm=False)
    direction = RANDOM.standard_normal(problem.size)
    expected = slope(lambda x: problem.loss_and_gradient(x)[0], x, direction, 1e-5)
    assert gradient @ direction == pytest.approx(expected, rel=1e-5)


def test_the_implicit_gradient_in_every_input(problem):
    x = problem.start
    state = problem.solve(x, warm=False)
    weights = [RANDOM.standard_normal(part.shape) for part in (state.corners, state.reactions)] + [3.0]

    def value(x, loads=None, thickness=None, stress=1.0):
        at = problem.solve(x, loads, thickness, stress)
        return np.sum(weights[0] * at.corners) + np.sum(weights[1] * at.reactions) + weights[2] * at.load_factor

    gradient = problem.pullback(x, state.configuration, *weights)
    direction = RANDOM.standard_normal(x.size)
    close = dict(rel=1e-5)
    assert gradient["design"] @ direction == pytest.approx(slope(value, x, direction, 1e-4), **close)
    loads = problem.loads
    scale = np.sum(gradient["loads"] * loads)
    assert scale == pytest.approx(slope(lambda f: value(x, f * loads), 1.0, 1.0, 1e-3), rel=1e-5, abs=1e-5)
    assert gradient["stress"] == pytest.approx(slope(lambda e: value(x, stress=e), 1.0, 1.0, 1e-3), **close)
    if "thickness" in problem.differentiable:
        t = problem.thickness
        assert gradient["thickness"] == pytest.approx(slope(lambda t: value(x, thickness=t), t, 1.0, 1e-3 * t), **close)
    else:
        assert gradient["thickness"] is None
        with pytest.raises(kg.InvalidDesign, match="does not determine the hinges of a sheet of another thickness"):
            problem.solve(x, thickness=2 * problem.thickness)


def test_the_path_is_that_of_the_command_line(problem, program):
    scene = SCENES / {9: "pet-3x3.toml", 12: "a4-plate.toml", 49: "linear-7x7.toml"}[problem.loads.shape[0]]
    printed = subprocess.run([program, "inspect", "equilibrium", scene, "--design", "start"], capture_output=True, check=True).stdout
    steps = json.loads(printed)["steps"]
    path = problem.equilibrium(problem.start, warm=False)
    assert path.followed and path.status == [step["status"] for step in steps]
    np.testing.assert_allclose(path.configuration, [step["q"] for step in steps], rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(path.energy, [step["hinge_energy"] for step in steps], rtol=1e-7, atol=1e-9)


def test_warm_starts_agree_and_are_followed_now_and_then(film_problem):
    problem = film_problem
    problem.forget()
    x = problem.start
    first = problem.solve(x)
    followed = [first.followed]
    for _ in range(32):
        x = x + 0.01 * RANDOM.standard_normal(x.size)
        warm, cold = problem.solve(x), kg.Problem(SCENES / "pet-3x3.toml").solve(x)
        followed.append(warm.followed)
        np.testing.assert_allclose(warm.corners, cold.corners, atol=1e-7)
    assert followed == [True] + 29 * [False] + [True] + 2 * [False]


def test_a_batch_is_its_elements(problem):
    x = problem.start + 0.02 * RANDOM.standard_normal((5, problem.size))
    states = problem.solve_many(x)
    for row, state in zip(x, states):
        np.testing.assert_allclose(state.corners, problem.solve(row, warm=False).corners, atol=1e-7)
    stresses = np.array([0.9, 1.0, 1.1])
    states = problem.solve_many(problem.start, stress=stresses)
    for stress, state in zip(stresses, states):
        np.testing.assert_allclose(state.corners, problem.solve(problem.start, stress=stress, warm=False).corners, atol=1e-7)


def test_what_has_no_equilibrium_in_a_batch_is_named(film_problem):
    problem = film_problem
    loads = np.stack([problem.loads, 1e6 * problem.loads])
    x = problem.start
    bad = np.array([x, x])
    bad[1, problem.blocks["z"]] = 800.0
    with pytest.raises(kg.InvalidDesign, match="element 1: "):
        problem.solve_many(bad)
    good, failed = problem.solve_many(bad, strict=False)
    assert good.status == "left-domain" and isinstance(failed, kg.InvalidDesign)
    assert len(problem.solve_many(x, loads=loads, strict=False)) == 2
    with pytest.raises(ValueError, match=r"`loads` has the shape \(2, 9, 3\), expected .* \(3, ...\) of these"):
        problem.solve_many(np.stack([x, x, x]), loads=loads)


def test_a_pickled_problem_is_the_same_problem_in_another_folder(problem, tmp_path, monkeypatch):
    stored = pickle.dumps(problem)
    monkeypatch.chdir(tmp_path)
    again = pickle.loads(stored)
    np.testing.assert_array_equal(again.solve(again.start).corners, problem.solve(problem.start, warm=False).corners)


INHERITED = []


def solved(problem=None):
    problem = problem or INHERITED[0]
    return problem.solve(problem.start).load_factor


def error_in_a_fork(problem):
    solved(problem)
    INHERITED.append(problem)
    with multiprocessing.get_context("fork").Pool(1) as pool, pytest.raises(RuntimeError) as error:
        pool.apply_async(solved).get(timeout=30)
    return str(error.value)


def test_processes_are_spawned_and_a_fork_is_an_error_at_once(film_problem):
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        assert pool.submit(solved, film_problem).result() == pytest.approx(solved(film_problem))
        # In a process without JAX, which refuses forks itself.
        assert "spawn" in pool.submit(error_in_a_fork, film_problem).result(timeout=60)


def test_a_scene_from_a_dict(film_problem):
    keys = kg.read_scene(SCENES / "pet-3x3.toml")
    keys["loads"][0]["force"] = np.array([27.85, 0.0])
    keys["surrogate"]["weights"] = SCENES / keys["surrogate"]["weights"]
    problem = kg.Problem(keys, folder=SCENES)
    np.testing.assert_array_equal(problem.solve(problem.start).corners, film_problem.solve(film_problem.start, warm=False).corners)
    keys["ligaments"] = 3
    with pytest.raises(kg.InvalidScene, match="unknown key `ligaments`; did you mean `ligament`?"):
        kg.Problem(keys, folder=SCENES)
    del keys["ligaments"]
    keys["load_steps"] = 0
    with pytest.raises(kg.InvalidScene, match="load_steps"):
        kg.Problem(keys, folder=SCENES)
    with pytest.raises(kg.InvalidScene, match="cannot read .*missing.toml"):
        kg.Problem("missing.toml")
    with pytest.raises(TypeError, match="neither a path nor a dict"):
        kg.Problem(3)


def test_widths(film_problem):
    x = film_problem.with_widths(film_problem.start, 12.5)
    np.testing.assert_allclose(film_problem.sheet(x).w_lig, 12.5, rtol=1e-12)
    with pytest.raises(ValueError, match=r"w_lig\[0\] = 99 mm violates 10 < w_lig < 25"):
        film_problem.with_widths(x, 99.0)


def test_pins_have_a_kinematic_deployment_and_no_equilibrium():
    problem = kg.Problem(SCENES / "pin-7x7.toml")
    path = problem.deploy(problem.start)
    assert len(path) == 1 and np.isnan(path.damage).all()
    with pytest.raises(kg.InvalidDesign, match="the level `pin` has no equilibrium"):
        problem.equilibrium(problem.start)
    opening = problem.start[problem.blocks["opening"]][0]
    _, corners = problem.sheet(problem.start).deploy(opening)
    np.testing.assert_allclose(path.corners[0], corners, atol=1e-9)


def test_a_problem_has_the_level_that_is_named():
    plate = SCENES / "a4-plate.toml"
    standard, draft = (kg.Problem(plate, level=level) for level in ("standard", "draft"))
    ends = [problem.deploy(problem.start).corners[-1] for problem in (standard, draft)]
    assert 0.0 < np.abs(ends[0] - ends[1]).max() < 0.05
    with pytest.raises(ValueError, match="expected one of pin, linear"):
        kg.Problem(plate, level="everyday")


def test_patterns_and_sheets():
    pattern = kg.Pattern(3, 2, [300.0, 200.0])
    assert pattern.r.tolist() == [0.5, 0.5] and pattern.tau.size == 2 * 2 + 2
    sheet = kg.Sheet(pattern, 8.0)
    assert sheet.corners.shape == (6, 4, 2) and len(sheet.hinge_panels) == pattern.hinges == 7
    _, flat = sheet.deploy(0.0)
    np.testing.assert_array_equal(flat, sheet.corners)
    _, opened = sheet.deploy(0.5)
    sides = lambda corners: np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    np.testing.assert_allclose(sides(opened), sides(flat), rtol=1e-12)
    with pytest.raises(kg.InvalidDesign, match="r"):
        kg.Pattern(3, 2, [300.0, 200.0], r=[0.5, 1.0])
    with pytest.raises(ValueError, match="at least 2 x 2"):
        kg.Pattern(1, 2, [300.0, 200.0])
    with pytest.raises(kg.InvalidDesign, match=r"w_lig\[2\] = -1 mm is not a positive"):
        kg.Sheet(pattern, [8.0, 8.0, -1.0, 8.0, 8.0, 8.0, 8.0])


def test_a_search_calls_back_and_ends_on_request(film_problem):
    records = []

    def callback(record):
        records.append(record)
        return record["step"] == 3

    x, ended, history = film_problem.design(steps=10, callback=callback)
    assert ended == "stopped" and history == records and [record["step"] for record in records] == [0, 1, 2, 3]
    assert history[-1]["loss"] < history[0]["loss"]
    assert film_problem.loss_and_gradient(x, warm=False)[0] == pytest.approx(min(record["loss"] for record in history), rel=1e-6)
    with pytest.raises(ZeroDivisionError):
        film_problem.design(steps=10, callback=lambda record: 1 / 0)
    with pytest.raises(ValueError, match='`method` is "sgd"'):
        film_problem.design(method="sgd")


def interrupted_after(seconds):
    """Sends Ctrl-C to this process."""
    timer = threading.Timer(seconds, signal.raise_signal, [signal.SIGINT])
    timer.start()
    return timer


@pytest.mark.parametrize("call", [lambda p: p.design(steps=100_000), lambda p: p.solve_many(np.tile(p.start, (100_000, 1)))])
def test_control_c_ends_long_calls(film_problem, call):
    interrupted_after(0.5)
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        call(film_problem)
    assert time.monotonic() - began < 20


def test_control_c_ends_a_single_path():
    bell = kg.Problem(SCENES / "pet-bell-16x22.toml")
    began = time.monotonic()
    bell.deploy(bell.start, warm=False)
    whole = time.monotonic() - began
    interrupted_after(0.1 * whole)
    with pytest.raises(KeyboardInterrupt):
        bell.deploy(bell.start, warm=False)
    # The next path is followed to its end.
    bell.equilibrium(bell.start, warm=False)


def test_other_threads_run_while_a_path_is_followed(film_problem):
    ticks, done = [], threading.Event()

    def tick():
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(1e-4)

    thread = threading.Thread(target=tick)
    thread.start()
    began = time.monotonic()
    film_problem.solve_many(film_problem.start + 0.1 * RANDOM.standard_normal((50, film_problem.size)))
    ended = time.monotonic()
    done.set()
    thread.join()
    assert sum(began < at < ended for at in ticks) > 5


@pytest.mark.parametrize("x", [np.zeros(3), np.zeros((2, 40)), None, "start"])
def test_a_vector_of_another_size_is_refused(film_problem, x):
    with pytest.raises((ValueError, TypeError), match="`x`"):
        film_problem.solve(x)


def test_a_jump_at_a_limit_point_is_reported_and_the_gradient_is_that_of_the_new_branch(film_problem):
    """Pushed instead of pulled, the sheet snaps to another branch, as `kirigami inspect equilibrium` reports it."""
    problem, x = film_problem, film_problem.start
    loads = -problem.loads
    path = problem.equilibrium(x, loads=loads, warm=False)
    assert "limit-point" in path.status
    state = problem.solve(x, loads=loads, warm=False)
    assert state.status == "limit-point"
    weights = RANDOM.standard_normal(state.corners.shape)
    gradient = problem.pullback(x, state.configuration, weights, np.zeros_like(state.reactions), 0.0, loads=loads)
    value = lambda factor: np.sum(weights * problem.solve(x, factor * loads, warm=False).corners)
    assert np.sum(gradient["loads"] * loads) == pytest.approx(slope(value, 1.0, 1.0, 1e-3), rel=1e-4)


def test_a_configuration_that_is_no_equilibrium_has_no_gradient(film_problem):
    problem, x = film_problem, film_problem.start
    state = problem.solve(x)
    by = np.ones_like(state.corners), np.zeros_like(state.reactions), 0.0
    with pytest.raises(kg.NoEquilibrium, match="no equilibrium was found beyond load factor 1.0000"):
        problem.pullback(x, state.configuration + 0.1, *by)


def test_another_thickness_is_that_of_the_scene(film_problem):
    keys = kg.read_scene(SCENES / "pet-3x3.toml")
    keys["thickness"] = 1.02 * film_problem.thickness
    keys["process"]["r_win"] *= 1.02
    thicker = kg.Problem(keys, folder=SCENES)
    expected = thicker.solve(thicker.start)
    found = film_problem.solve(film_problem.start, thickness=keys["thickness"], warm=False)
    np.testing.assert_allclose(found.corners, expected.corners, atol=1e-7)
    np.testing.assert_allclose(found.reactions, expected.reactions, atol=1e-6)


def test_loads_that_are_no_inputs_have_no_gradient():
    """At supports no load is possible; under a prescribed stroke the sum of forces has a kink at panels without one."""
    problem = kg.Problem(SCENES / "a4-plate.toml")
    state = problem.solve(problem.start)
    by = np.ones_like(state.corners), np.ones_like(state.reactions), 1.0
    gradient = problem.pullback(problem.start, state.configuration, *by)["loads"]
    pulled = np.hypot(*problem.loads[:, :2].T) > 0
    assert pulled.sum() == 1 and np.abs(gradient[pulled]).min() > 0
    assert (gradient[~pulled, :2] == 0).all()
    clamped = np.abs(state.reactions).max(axis=1) > 0
    assert (gradient[clamped] == 0).all()
    loads = problem.loads
    loads[clamped] = 1.0
    with pytest.raises(kg.InvalidDesign, match="where it is supported: loads act on free degrees of freedom"):
        problem.solve(problem.start, loads=loads)


def test_a_problem_is_shared_by_threads(film_problem):
    designs = film_problem.start + 0.02 * RANDOM.standard_normal((16, film_problem.size))
    with ThreadPoolExecutor(4) as threads:
        states = list(threads.map(film_problem.solve, designs))
    for x, state in zip(designs, states):
        np.testing.assert_allclose(state.corners, film_problem.solve(x, warm=False).corners, atol=1e-7)


def test_a_design_of_ones_own_is_written_as_a_run(film_problem, tmp_path):
    x = film_problem.start + 0.01 * RANDOM.standard_normal(film_problem.size)
    folder = tmp_path / "run"
    report = film_problem.write(x, folder, force=True)
    assert report["cut_file"] and report["steps"] == 0
    for name in ("cut.dxf", "run.html", "deployed.svg", "scene.toml"):
        assert (folder / name).stat().st_size > 1000, name
    loss, _ = kg.Problem(folder).loss_and_gradient(kg.Run.read(folder).design)
    assert loss == pytest.approx(film_problem.loss_and_gradient(x, warm=False)[0], rel=1e-9)
    # Another design replaces it, but not files of others.
    film_problem.write(film_problem.start, folder, force=True)
    assert kg.Run.read(folder).history[0]["loss"] != loss
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(ValueError, match="no run has written"):
        film_problem.write(x, tmp_path)
