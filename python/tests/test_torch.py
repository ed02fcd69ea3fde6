"""The equilibrium in PyTorch: gradcheck, batches, refused derivatives. Skipped where PyTorch is not installed."""

import kirigami as kg
import numpy as np
import pytest
from conftest import SCENES

torch = pytest.importorskip("torch")
import kirigami.torch  # noqa: E402


@pytest.fixture(scope="module", params=["pet-3x3", "a4-plate"])
def problem(request):
    """Dead loads on a clamped film; a hanging, heavy plate with a prescribed stroke."""
    return kg.Problem(SCENES / f"{request.param}.toml")


def test_gradcheck_in_all_inputs(problem):
    state = problem.solve(problem.start)
    # Forces on panels without one are no inputs under a prescribed stroke: the loads are scaled as a whole.
    loads = torch.tensor(problem.loads)

    def scaled(x, factor, thickness, stress):
        at = kirigami.torch.equilibrium(problem, x, factor * loads, problem.thickness * thickness, stress)
        size = float(np.abs(state.corners).max())
        return at.corners / size, at.reactions / float(np.abs(state.reactions).max()), at.load_factor

    one = lambda: torch.tensor(1.0, dtype=torch.float64, requires_grad=True)
    x = torch.tensor(problem.start, requires_grad=True)
    assert torch.autograd.gradcheck(scaled, (x, one(), one(), one()), eps=1e-4, atol=1e-6, rtol=1e-4, fast_mode=True)


def test_what_has_no_equilibrium_is_nan_on_request(problem):
    designs = np.array([problem.start, problem.start])
    designs[1, problem.blocks["z"]] = 800.0
    x = torch.tensor(designs, requires_grad=True)
    corners = kirigami.torch.equilibrium(problem, x, strict=False).corners
    corners[..., 0].amax((1, 2)).sum().backward()
    assert corners[0].isfinite().all() and x.grad[0].isfinite().all()
    assert corners[1].isnan().all() and x.grad[1].isnan().all()


def test_a_batch_is_its_elements(problem):
    designs = problem.start + 0.02 * np.random.default_rng(1).standard_normal((3, problem.size))
    x = torch.tensor(designs, requires_grad=True)
    corners = kirigami.torch.equilibrium(problem, x).corners
    assert corners.shape == (3, *problem.solve(problem.start).corners.shape)
    corners[..., 0].amax((1, 2)).sum().backward()
    for design, gradient in zip(designs, x.grad):
        alone = torch.tensor(design, requires_grad=True)
        kirigami.torch.equilibrium(problem, alone).corners[..., 0].max().backward()
        torch.testing.assert_close(gradient, alone.grad, rtol=1e-6, atol=1e-6 * float(alone.grad.abs().max()))


def test_derivatives_that_do_not_exist_are_refused(problem):
    x = torch.tensor(problem.start, requires_grad=True)
    (gradient,) = torch.autograd.grad(kirigami.torch.equilibrium(problem, x).corners.sum(), x, create_graph=True)
    with pytest.raises(NotImplementedError, match="cannot be differentiated twice"):
        gradient.sum().backward()
    springs = kg.Problem(SCENES / "linear-7x7.toml")
    thickness = torch.tensor(springs.thickness, dtype=torch.float64, requires_grad=True)
    with pytest.raises(TypeError, match="no derivative in `thickness`"):
        kirigami.torch.equilibrium(springs, torch.tensor(springs.start), thickness=thickness)


def test_wrong_inputs_and_missing_equilibria_are_refused(problem):
    x = torch.tensor(problem.start)
    with pytest.raises(TypeError, match="`x` is torch.float32"):
        kirigami.torch.equilibrium(problem, x.float())
    with pytest.raises(ValueError, match=r"`loads` has the shape \(2, 3\)"):
        kirigami.torch.equilibrium(problem, x, loads=torch.zeros(2, 3))
    with pytest.raises(kg.InvalidDesign, match="are not positive"):
        kirigami.torch.equilibrium(problem, x, stress=torch.tensor(-1.0))


def test_an_objective_through_a_network(problem):
    """A network that maps a parameter to a design is trained through the equilibrium."""
    torch.manual_seed(0)
    network = torch.nn.Linear(1, problem.size, dtype=torch.float64)
    torch.nn.init.zeros_(network.weight)
    network.bias.data = torch.tensor(problem.start)
    optimiser = torch.optim.Adam(network.parameters(), 0.01)
    width = lambda: kirigami.torch.equilibrium(problem, network(torch.ones(1, dtype=torch.float64))).corners[..., 0].max()
    first = width().item()
    for _ in range(5):
        optimiser.zero_grad()
        loss = -width()
        loss.backward()
        optimiser.step()
    assert width().item() > first
