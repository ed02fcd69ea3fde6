"""The files of the repository that the tests read."""

from pathlib import Path

import kirigami as kg
import pytest

REPOSITORY = Path(__file__).parents[2]
DATA = REPOSITORY / "data"
SCENES = REPOSITORY / "configs" / "scenes"


@pytest.fixture(scope="session")
def film():
    """The polyester film with its ensemble."""
    files = [DATA / "pet-0.5mm" / f"medium{number}.safetensors" for number in ("", "-1", "-2", "-3")]
    return kg.Surrogate.load(files[0], ensemble=files[1:])


def slope(function, at, direction, step):
    """Derivative of an array-valued function along a direction, by central differences of fourth order."""
    def difference(h):
        return (function(at + h * direction) - function(at - h * direction)) / (2 * h)

    return (4 * difference(step) - difference(2 * step)) / 3


@pytest.fixture(scope="session")
def program():
    """The command line, if it was built."""
    program = REPOSITORY / "target" / "release" / "kirigami"
    if not program.exists():
        pytest.skip(f"{program} is not built: cargo build --release")
    return program
