"""Do features in units of the yield strain help a metal? The energy (14), trained from scratch on the features (13) and on these
and e / (|e|^2 + 0.01^2)^(1/4), e = (eta_a, eta_s, theta), whose square grows as the energy of a hinge that yields: in proportion to |e|.

    pip install jax numpy polars
    python docs/results/metals/features.py data/s235-1.5mm SEEDS
"""

import json
import sys

import jax
import jax.numpy as jnp
import numpy as np
import polars as pl

WIDTHS, EPOCHS, BATCH, RATE = (128, 128, 128, 64), 80, 128, 5e-3


def read(rows):
    """Features (13) and, in the last axis, W and its derivatives by eta_a, eta_s and theta."""
    w = rows["w_lig"].to_numpy()
    x = np.stack([*rows.select("eta_a", "eta_s", "theta").to_numpy().T, np.log(w), rows["alpha"].to_numpy()], 1)
    forces = rows.select("W", "F_a", "F_s", "M_theta").to_numpy()
    return x, forces


def mirrored(x, forces):
    y, g = x.copy(), forces.copy()
    y[:, 1], y[:, 4], g[:, 2] = -x[:, 1], np.pi - x[:, 4], -forces[:, 2]
    return np.concatenate([x, y]), np.concatenate([forces, g])


def plain(x):
    return x


def radial(x):
    e = x[..., :3]
    return jnp.concatenate([x, e / (jnp.sum(e * e, -1, keepdims=True) + 1e-4) ** 0.25], -1)


def train(features, x, forces, seed):
    """The energy and its three forces as a function of x."""
    scale = np.sqrt((forces**2).mean(0))
    z = np.asarray(features(jnp.asarray(x)))
    mean, std = z.mean(0), z.std(0)
    key = jax.random.PRNGKey(seed)
    layers = []
    for inputs, outputs in zip((z.shape[1], *WIDTHS), WIDTHS):
        key, part = jax.random.split(key)
        limit = (6 / (inputs + outputs)) ** 0.5
        layers.append((jax.random.uniform(part, (outputs, inputs), minval=-limit, maxval=limit), jnp.zeros(outputs)))

    def embedding(layers, x):
        h = (features(x) - mean) / std
        for weight, bias in layers[:-1]:
            h = jnp.tanh(weight @ h + bias)
        return layers[-1][0] @ h + layers[-1][1]

    def energy(layers, x):
        return jnp.sum((embedding(layers, x) - embedding(layers, x.at[:3].set(0.0))) ** 2)

    def law(layers, x):
        """In the scales of W and of the forces."""
        w, by = jax.value_and_grad(energy, argnums=1)(layers, x)
        length = jnp.stack([jnp.exp(x[3]), jnp.exp(x[3]), 1.0])
        return jnp.concatenate([w[None], by[:3] * scale[0] / length / scale[1:]])

    laws = jax.vmap(law, (None, 0))
    inputs, targets = jnp.asarray(x, jnp.float32), jnp.asarray(forces / scale, jnp.float32)
    steps = EPOCHS * len(x) // 2 // BATCH  # an epoch is the rays, without their mirror images

    def loss(layers, batch):
        square = jnp.mean((laws(layers, inputs[batch]) - targets[batch]) ** 2, 0)
        return 0.5 * square[0] + 0.5 * jnp.mean(square[1:])

    def step(state, t):  # Adam with half a cosine, the norm of each gradient limited to 1
        layers, first, second, key = state
        key, part = jax.random.split(key)
        gradient = jax.grad(loss)(layers, jax.random.randint(part, (BATCH,), 0, len(x)))
        gradient = jax.tree.map(lambda g: g * jnp.minimum(1, 1 / (jnp.linalg.norm(g) + 1e-9)), gradient)
        first = jax.tree.map(lambda m, g: 0.9 * m + 0.1 * g, first, gradient)
        second = jax.tree.map(lambda v, g: 0.999 * v + 0.001 * g * g, second, gradient)
        rate, t = RATE * 0.5 * (1 + jnp.cos(jnp.pi * t / steps)), t + 1.0

        def moved(p, m, v):
            return p - rate * m / (1 - 0.9**t) / (jnp.sqrt(v / (1 - 0.999**t)) + 1e-8)

        return (jax.tree.map(moved, layers, first, second), first, second, key), None

    zeros = jax.tree.map(jnp.zeros_like, layers)
    state = (layers, zeros, zeros, jax.random.PRNGKey(seed + 100))
    layers = jax.jit(lambda state: jax.lax.scan(step, state, jnp.arange(steps))[0])(state)[0]
    return lambda x: np.asarray(jax.jit(laws)(layers, jnp.asarray(x, jnp.float32))) * scale


folder, seeds = sys.argv[1], int(sys.argv[2])
rays, spot = (pl.read_parquet(f"{folder}/{name}.parquet") for name in ("hinges", "spot-check"))
trained = pl.col("job").is_in(json.load(open(f"{folder}/hinges.json"))["split"]["training"])
parts = {"training": read(rays.filter(trained)), "unseen": read(rays.filter(~trained)), "spot check": read(spot)}
print("| features | law | states | W | F_a | F_s | M |\n|---|---|---|---|---|---|---|")
for features in (plain, radial):
    laws = [train(features, *mirrored(*parts["training"]), seed) for seed in range(seeds)]
    for part, (x, forces) in parts.items():
        answers = np.stack([law(x) for law in laws])
        rms = np.sqrt((forces**2).mean(0))
        each = np.sqrt(((answers - forces) ** 2).mean(1)) / rms
        together = np.sqrt(((np.median(answers, 0) - forces) ** 2).mean(0)) / rms
        for name, errors in ((f"mean of {seeds}", each.mean(0)), ("their median", together)):
            print(f"| {features.__name__} | {name} | {part} |", " | ".join(f"{100 * e:.1f} %" for e in errors), "|", flush=True)
