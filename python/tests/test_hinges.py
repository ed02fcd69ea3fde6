"""The learned hinge energy from Python: derivatives, shapes, and arguments that are refused."""


import pickle

import kirigami as kg
import numpy as np
import pytest
from conftest import DATA, slope

WIDTH, ANGLE = 10.0, 1.2


def random_states(count, seed=0):
    """States (a, s, theta) inside the training domain of the film."""
    return np.random.default_rng(seed).uniform([-0.3, -0.3, 0.1], [0.3, 0.3, 0.6], (count, 3))


def test_forces_and_tangent_are_derivatives_of_the_energy(film):
    states = random_states(5)
    at = film(states, WIDTH, ANGLE)
    for c, direction in enumerate(np.eye(3)):
        energy = slope(lambda x: film(x, WIDTH, ANGLE).energy, states, direction, 3e-4)
        forces = slope(lambda x: film(x, WIDTH, ANGLE).forces, states, direction, 3e-4)
        np.testing.assert_allclose(at.forces[:, c], energy, rtol=1e-8, atol=1e-8)
        np.testing.assert_allclose(at.tangent[:, :, c], forces, rtol=1e-7, atol=1e-7)


def test_a_pickled_surrogate_has_its_ensemble(film):
    again, states = pickle.loads(pickle.dumps(film)), random_states(4)
    np.testing.assert_array_equal(again(states, WIDTH, ANGLE).spread, film(states, WIDTH, ANGLE).spread)


def test_derivatives_in_the_design(film):
    states = random_states(3)
    at = film(states, WIDTH, ANGLE, order="design")
    hole = film.card["hinge"]["fillet_ratio"]
    design = np.array([WIDTH, ANGLE, hole])
    for c, direction in enumerate(np.eye(3)):
        energy = slope(lambda g: film(states, *g).energy, design, direction, 3e-4)
        forces = slope(lambda g: film(states, *g).forces, design, direction, 3e-4)
        np.testing.assert_allclose(at.by_design[:, c], energy, rtol=1e-7, atol=1e-8)
        np.testing.assert_allclose(at.forces_by_design[:, :, c], forces, rtol=1e-7, atol=1e-7)


def test_prepared_hinges_have_the_same_values_in_any_shape(film):
    states = random_states(6).reshape(2, 3, 3)
    widths = np.linspace(6.0, 20.0, 6).reshape(2, 3)
    once = film(states, widths, ANGLE)
    hinges = film.hinges(widths, ANGLE)
    assert hinges.shape == [2, 3]
    for name, shape in [("energy", ()), ("forces", (3,)), ("tangent", (3, 3)), ("damage", ()), ("damage_peak", ()), ("depth", ())]:
        found = getattr(hinges(states), name)
        assert found.shape == (2, 3, *shape) and found.dtype == np.float64
        np.testing.assert_array_equal(found, getattr(once, name))
    alone = film(states[1, 2], widths[1, 2], ANGLE)
    assert alone.energy.shape == ()
    np.testing.assert_allclose(alone.energy, once.energy[1, 2], rtol=1e-12)


def test_spread_and_what_is_not_known(film):
    inside = film([0.1, 0.1, 0.3], WIDTH, ANGLE)
    energies = [
        kg.Surrogate.load(DATA / "pet-0.5mm" / f"medium{number}.safetensors")([0.1, 0.1, 0.3], WIDTH, ANGLE).energy
        for number in ("", "-1", "-2", "-3")
    ]
    np.testing.assert_allclose(inside.spread[0], np.std(energies, ddof=1), rtol=1e-9)
    outside = film([8.0, 0.0, 0.3], WIDTH, ANGLE)
    assert outside.depth < 0 and not outside.inside and np.isnan(outside.damage)
    alone = kg.Surrogate.load(DATA / "pet-0.5mm" / "small.safetensors")
    with pytest.raises(ValueError, match="one network has no spread"):
        _ = alone([0.1, 0.1, 0.3], WIDTH, ANGLE).spread
    with pytest.raises(ValueError, match='order="tangent"'):
        _ = alone([0.1, 0.1, 0.3], WIDTH, ANGLE, order="forces").tangent


def test_a_field_of_records_is_read_as_its_numbers(film):
    records = np.zeros(3, dtype=[("id", "i4"), ("w_lig", "f8")])
    records["w_lig"] = [9.0, 12.0, 18.0]
    states = np.full((3, 3), 0.1)
    np.testing.assert_array_equal(film(states, records["w_lig"], ANGLE).energy, film(states, [9.0, 12.0, 18.0], ANGLE).energy)


@pytest.mark.parametrize("layout", [np.asfortranarray, lambda x: np.repeat(x, 2, axis=0)[::2], lambda x: x[::-1][::-1], lambda x: x.astype(">f8"), lambda x: x.tolist()])
def test_the_layout_in_memory_does_not_matter(film, layout):
    states = random_states(7)
    np.testing.assert_array_equal(film(layout(states), WIDTH, ANGLE).energy, film(states, WIDTH, ANGLE).energy)


def test_short_floats_and_integers_are_read_exactly(film):
    states = random_states(4).astype(np.float32)
    np.testing.assert_array_equal(film(states, 10, ANGLE).energy, film(states.astype(float), 10.0, ANGLE).energy)


@pytest.mark.parametrize(
    ("states", "error", "message"),
    [
        ([[1.0, 2.0]], ValueError, r"`states` has the shape \(1, 2\), expected \(\.\.\., 3\)"),
        (0.3, ValueError, r"`states` has the shape \(\)"),
        ([[0.0, 0.1, 0.2], [0.0, np.nan, 0.2]], ValueError, r"`states`\[1, 1\] = NaN is not a finite number"),
        ([0.0, np.inf, 0.2], ValueError, r"`states`\[1\] = inf is not a finite number"),
        (np.array([1, 2, 3j]), TypeError, "`states` is an array of complex128"),
        (np.array([True, False, True]), TypeError, "`states` is an array of bool"),
        (np.array([1, 2, 3], dtype=np.longdouble), TypeError, "`states` is an array of float128"),
        (np.ma.masked_array([1.0, 2.0, 3.0], [0, 1, 0]), TypeError, "`states` is a masked array"),
        ("abc", TypeError, "`states` is an array of <U3"),
        (None, TypeError, "`states` is an array of object"),
        ([[1.0, 2.0], [3.0]], TypeError, "`states` is no array"),
    ],
)
def test_what_is_no_array_of_states_is_refused(film, states, error, message):
    with pytest.raises(error, match=message):
        film(states, WIDTH, ANGLE)


def test_hinges_that_cannot_be_cut_are_refused(film):
    with pytest.raises(ValueError, match=r"hinge 0: w_lig = 0.01 mm violates .*did you mean 10 mm"):
        film.hinges(0.01, ANGLE)
    with pytest.raises(ValueError, match="hinge 1: alpha"):
        film.hinges(10.0, [1.0, 4.0])
    with pytest.raises(ValueError, match=r"`w_lig` has the shape \(2,\), expected a number or \(3,\)"):
        film.hinges([10.0, 11.0], [1.0, 1.1, 1.2])
    with pytest.raises(ValueError, match=r"`states` has the shape \(3,\), expected \(2, 3\)"):
        film.hinges([10.0, 11.0], ANGLE)([0.1, 0.1, 0.3])


def test_weights_that_cannot_be_read_are_exceptions_with_the_words_of_the_command_line(tmp_path):
    with pytest.raises(kg.WeightsError, match="cannot read .*missing.safetensors"):
        kg.Surrogate.load(tmp_path / "missing.safetensors")
    with pytest.raises(kg.WeightsError, match="is a database"):
        kg.Surrogate.load(DATA / "pet-0.5mm" / "hinges.parquet")
