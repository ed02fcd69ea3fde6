"""The equilibrium in JAX: gradients against central differences, transformations, refused derivatives."""

import kirigami as kg
import numpy as np
import pytest
from conftest import SCENES

jax = pytest.importorskip("jax")
import jax.numpy as jnp  # noqa: E402
from jax.test_util import check_grads  # noqa: E402

import kirigami.jax  # noqa: E402

jax.config.update("jax_enable_x64", True)


@pytest.fixture(scope="module", params=["pet-3x3", "a4-plate"])
def problem(request):
    """Dead loads on a clamped film; a hanging, heavy plate with a prescribed stroke."""
    return kg.Problem(SCENES / f"{request.param}.toml")


@pytest.fixture(scope="module")
def equilibrium(problem):
    return kirigami.jax.equilibrium(problem)


def test_the_values_are_those_of_the_problem(problem, equilibrium):
    found, expected = equilibrium(problem.start), problem.solve(problem.start, warm=False)
    np.testing.assert_allclose(found.corners, expected.corners, atol=1e-7)
    np.testing.assert_allclose(found.reactions, expected.reactions, atol=1e-7 * np.abs(expected.reactions).max())
    assert float(found.load_factor) == pytest.approx(expected.load_factor, rel=1e-9)


def test_gradients_in_all_inputs(problem, equilibrium):
    """Every output in every input along random directions, in reverse mode, against central differences."""
    outputs = equilibrium(problem.start)
    sizes = jax.tree.map(lambda output: jnp.abs(output).max(), outputs)

    def scaled(x, factor, thickness, stress):
        at = equilibrium(x, factor * problem.loads, problem.thickness * thickness, stress)
        return jax.tree.map(lambda output, size: output / size, at, sizes)

    check_grads(scaled, (jnp.asarray(problem.start), 1.0, 1.0, 1.0), order=1, modes=["rev"], atol=1e-6, rtol=1e-6, eps=1e-4)


def test_what_has_no_equilibrium_is_nan_on_request(problem):
    designs = np.array([problem.start, problem.start])
    designs[1, problem.blocks["z"]] = 800.0
    equilibrium = kirigami.jax.equilibrium(problem, strict=False)
    values, gradients = jax.vmap(jax.value_and_grad(lambda x: equilibrium(x).corners[:, :, 0].max()))(designs)
    assert np.isfinite(values[0]) and np.isfinite(gradients[0]).all()
    assert np.isnan(values[1]) and np.isnan(gradients[1]).all()
    assert np.isnan(equilibrium(designs[1]).load_factor)


def test_jit_and_vmap_agree_with_single_calls(problem, equilibrium):
    designs = problem.start + 0.02 * np.random.default_rng(1).standard_normal((4, problem.size))

    def width(x, stress):
        return equilibrium(x, stress=stress).corners[:, :, 0].max()

    stresses = jnp.array([0.95, 1.0, 1.05, 1.1])
    value_and_gradient = jax.value_and_grad(width, argnums=(0, 1))
    values, (by_design, by_stress) = jax.jit(jax.vmap(value_and_gradient))(designs, stresses)
    for i, (x, stress) in enumerate(zip(designs, stresses)):
        value, (of_design, of_stress) = value_and_gradient(x, stress)
        assert float(values[i]) == pytest.approx(float(value), rel=1e-9)
        np.testing.assert_allclose(by_design[i], of_design, rtol=1e-6, atol=1e-6 * np.abs(of_design).max())
        assert float(by_stress[i]) == pytest.approx(float(of_stress), rel=1e-6)
    jacobian = jax.jacrev(lambda x: equilibrium(x).corners[0, 0])(problem.start)
    assert jacobian.shape == (2, problem.size)


def test_derivatives_that_do_not_exist_are_refused(problem, equilibrium):
    springs = kg.Problem(SCENES / "linear-7x7.toml")
    of_springs = kirigami.jax.equilibrium(springs)
    slope = jax.grad(lambda stress: of_springs(springs.start, stress=stress).corners[:, :, 0].max())(1.0)
    assert np.isfinite(slope)
    with pytest.raises(TypeError, match="no derivative in `thickness`: its hinge law determines those in design, loads, stress"):
        jax.grad(lambda t: of_springs(springs.start, thickness=t).load_factor)(springs.thickness)
    width = lambda x: equilibrium(x).corners[:, :, 0].max()
    with pytest.raises(NotImplementedError, match="cannot be differentiated twice"):
        jax.jacrev(jax.grad(width))(jnp.asarray(problem.start))
    with pytest.raises(TypeError, match="forward-mode"):
        jax.jvp(width, (jnp.asarray(problem.start),), (jnp.ones(problem.size),))


def test_wrong_inputs_are_refused(problem, equilibrium):
    with pytest.raises(ValueError, match=r"`x` has the shape \(3,\), expected"):
        equilibrium(jnp.zeros(3))
    with pytest.raises(ValueError, match=r"`loads` has the shape \(2, 3\)"):
        equilibrium(problem.start, loads=jnp.zeros((2, 3)))
    with jax.enable_x64(False), pytest.raises(TypeError, match="double precision"):
        equilibrium(problem.start)


def test_an_equilibrium_that_is_not_found_is_raised_with_the_words_of_the_command_line(equilibrium, problem):
    with pytest.raises(Exception, match="a ligament, the thickness or the stresses are not positive"):
        jax.block_until_ready(jax.jit(lambda stress: equilibrium(problem.start, stress=stress))(-1.0))


def test_an_optimiser_of_its_own(problem, equilibrium):
    """Gradient descent on an objective of the test: the corners onto the corners of another design."""
    target = equilibrium(problem.start + 0.05 * np.random.default_rng(2).standard_normal(problem.size)).corners
    loss = jax.jit(jax.value_and_grad(lambda x: jnp.mean((equilibrium(x).corners - target) ** 2)))
    x, values = jnp.asarray(problem.start), []
    for _ in range(10):
        value, gradient = loss(x)
        values.append(float(value))
        x = x - 0.03 * gradient / jnp.linalg.norm(gradient) * np.sqrt(problem.size) * 0.3
    assert min(values) < 0.5 * values[0]
