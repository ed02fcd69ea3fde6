"""What calls from Python cost: python python/benchmarks/cost.py [--program target/release/kirigami]

Prints the figures of the table in docs/PYTHON.md. The kernel's own time for the same 100 000 hinges is measured by `cargo bench -p surrogate shipped`.
"""

import argparse
import re
import subprocess
import tempfile
import time
from pathlib import Path

import kirigami as kg
import numpy as np

REPOSITORY = Path(__file__).parents[2]
SCENE = REPOSITORY / "configs" / "scenes" / "pet-3x3.toml"


def seconds(call, repeats, samples=7):
    """Time of a call: the shortest of some samples, which other work on the machine disturbs least."""
    times = []
    for _ in range(samples):
        began = time.perf_counter()
        for _ in range(repeats):
            call()
        times.append((time.perf_counter() - began) / repeats)
    return min(times)


def hinges():
    weights = kg.Surrogate.load(REPOSITORY / "data" / "pet-0.5mm" / "medium.safetensors")
    single = weights.hinges(18.0, 1.2)
    state = np.array([0.1, -0.1, 0.3])
    print(f"| a call for one prepared hinge, energy | {1e6 * seconds(lambda: single(state, 'value').energy, 5000):.1f} us |")
    print(f"| a call for one prepared hinge, energy, forces and tangent | {1e6 * seconds(lambda: single(state).tangent, 2000):.1f} us |")
    empty = weights.hinges(np.zeros(0), np.zeros(0))
    nothing = np.zeros((0, 3))
    print(f"| the call itself, for no hinge | {1e6 * seconds(lambda: empty(nothing, 'value').energy, 5000):.1f} us |")
    x = np.arange(100_000.0)
    states = np.column_stack([0.3 * np.sin(2.1 * x), 0.3 * np.sin(3.7 * x), 0.35 + 0.25 * np.sin(0.9 * x)])
    many = weights.hinges(np.full(x.size, 18.0), 1.2)
    for order, name in [("value", "energy"), ("forces", "forces"), ("tangent", "tangent")]:
        print(f"| 100 000 prepared hinges, up to the {name} | {1e3 * seconds(lambda: getattr(many(states, order), name), 1):.0f} ms |")


def adam(problem, steps, rate=0.03):
    """The search of the scene written in Python, and its time a step."""
    x, first, second = problem.start, 0.0, 0.0
    began = time.perf_counter()
    for step in range(1, steps + 1):
        _, gradient = problem.loss_and_gradient(x)
        first, second = 0.9 * first + 0.1 * gradient, 0.999 * second + 0.001 * gradient**2
        x = x - rate * (first / (1 - 0.9**step)) / (np.sqrt(second / (1 - 0.999**step)) + 1e-8)
    return (time.perf_counter() - began) / steps


def problems(program):
    problem = kg.Problem(SCENE)
    x = problem.start
    problem.solve(x)
    near = x + 0.01 * np.random.default_rng(0).standard_normal((10, x.size))
    designs = iter(np.tile(near, (1000, 1)))
    print(f"| pet-3x3: the equilibrium at full load, cold | {1e3 * seconds(lambda: problem.solve(x, warm=False), 1):.2f} ms |")
    print(f"| the same, warm, from a design near it | {1e3 * seconds(lambda: problem.solve(next(designs)), 10):.2f} ms |")
    state = problem.solve(x)
    by = np.ones_like(state.corners), np.ones_like(state.reactions), 1.0
    print(f"| its gradient in all inputs | {1e3 * seconds(lambda: problem.pullback(x, state.configuration, *by), 10):.2f} ms |")
    batch = np.tile(near, (10, 1))
    print(f"| 100 equilibria in one call | {1e3 * seconds(lambda: problem.solve_many(batch), 1, 3):.0f} ms |")
    steps = 150
    python, searches, short, long = [], [], [], []
    for _ in range(5):
        python.append(adam(kg.Problem(SCENE), steps))
        searches.append(seconds(lambda: problem.design(steps=steps), 1, 1) / steps)
        if program:
            short.append(command_line(program, 10))
            long.append(command_line(program, 10 + steps))
    print(f"| a step of its search: loss and gradient along the path, warm, from Python | {1e3 * min(python):.2f} ms |")
    print(f"| the same by `problem.design` | {1e3 * min(searches):.2f} ms |")
    if program:
        # Without the start of the program and the files of the run.
        print(f"| the same by `kirigami design` | {1e3 * (min(long) - min(short)) / steps:.2f} ms |")


def command_line(program, steps):
    """Time of a search by the command line."""
    with tempfile.TemporaryDirectory() as folder:
        keys = re.sub(r'"\.\./\.\./', f'"{REPOSITORY}/', SCENE.read_text())
        keys = re.sub(r'"\.\./', f'"{REPOSITORY}/configs/', keys)
        keys = re.sub(r"^output = .*$", 'output = "run"', keys, flags=re.MULTILINE)
        scene = Path(folder) / "scene.toml"
        scene.write_text(re.sub(r"^steps = \d+", f"steps = {steps}", keys, flags=re.MULTILINE))
        return seconds(lambda: subprocess.run([program, "design", scene, "--quiet"], check=True, capture_output=True), 1, 1)


if __name__ == "__main__":
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--program", help="the command line, for its own time a step")
    print("| call | time |\n|---|---|")
    hinges()
    problems(arguments.parse_args().program)
