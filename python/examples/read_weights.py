"""Reads and evaluates weights with NumPy alone: (13) and (14), at the reference hole 0.16 w_lig, inside the training domain.

    tensors = read_safetensors("data/pet-0.5mm/medium.safetensors")
    card = json.loads(Path("data/pet-0.5mm/medium.json").read_text())
"""

import json
import struct
from pathlib import Path

import numpy as np


def read_safetensors(path):
    """The tensors of a file by name."""
    data = Path(path).read_bytes()
    (size,) = struct.unpack("<Q", data[:8])
    header = json.loads(data[8 : 8 + size])
    header.pop("__metadata__", None)
    tensors = {}
    for name, entry in header.items():
        begin, end = (8 + size + offset for offset in entry["data_offsets"])
        dtype = {"F64": "<f8", "F32": "<f4"}[entry["dtype"]]
        tensors[name] = np.frombuffer(data[begin:end], dtype).reshape(entry["shape"])
    return tensors


def network(tensors, name, a, s, theta, w_lig, alpha):
    """The outputs of a network: the features (13), standardised, through layers of tanh and a linear one."""
    features = np.broadcast_arrays(a / w_lig, s / w_lig, theta, np.log(w_lig), alpha, 0.16)
    y = (np.stack(features, axis=-1) - tensors["feat_mean"]) / tensors["feat_std"]
    last = max(int(key.split(".")[1]) for key in tensors if key.startswith(name + "."))
    for n in range(last + 1):
        y = y @ tensors[f"{name}.{n}.weight"].T + tensors[f"{name}.{n}.bias"]
        y = np.tanh(y) if n < last else y
    return y


def energy(tensors, a, s, theta, w_lig, alpha):
    """W of (14) (N mm): the squared distance of the embedding from the flat hinge's."""
    r = network(tensors, "chi", a, s, theta, w_lig, alpha) - network(tensors, "chi", 0.0, 0.0, 0.0, w_lig, alpha)
    return tensors["w_scale"] * np.sum(r**2, axis=-1)


def damage(tensors, card, a, s, theta, w_lig, alpha):
    """D and D_peak of (14), shape (..., 2); softplus(y) = log(1 + e^y)."""
    beta = card["damage_sharpness"]
    heads = [network(tensors, name, a, s, theta, w_lig, alpha)[..., 0] for name in ("chi_d", "chi_p")]
    return tensors["d_scale"] * np.logaddexp(0.0, beta * np.stack(heads, axis=-1)) / beta
