"""Noise by its moments, and by its repeats."""
from __future__ import annotations

import math

import numpy as np
import pytest

from my_simulations.description.sensor import Noise as NoiseSpec
from my_simulations.sensing.noise import Noise, SampleGenerator, noisy_picture, sample_generator

MANY = 200_000


def test_none_changes_nothing():
    values = np.arange(3.0)
    assert Noise(NoiseSpec(stddev=1.0, bias_mean=3.0), 1, "s").apply(values, 0, 0.1) is values


def test_white_noise_has_its_mean_and_its_deviation():
    noise = Noise(NoiseSpec("gaussian", 0.5, 0.2), 1, "s")
    found = noise.apply(np.full(MANY, 10.0), 0, 0.1) - 10.0
    assert found.mean() == pytest.approx(0.5, abs=0.002)
    assert found.std() == pytest.approx(0.2, rel=0.01)
    assert ((found - 0.5) ** 3).mean() == pytest.approx(0.0, abs=0.001)
    assert (((found - 0.5) / 0.2) ** 4).mean() == pytest.approx(3.0, abs=0.05)


def test_a_sample_depends_on_seed_sensor_quantity_and_number_and_on_nothing_else():
    def sample(seed=1, sensor="robot::link::laser", quantity="range", number=7, before=()):
        noise = Noise(NoiseSpec("gaussian", 0.0, 1.0), seed, sensor, quantity)
        for one in before:
            noise.apply(np.zeros(100), one, 0.1)
        return noise.apply(np.zeros(4), number, 0.1).tolist()

    first = sample()
    assert sample() == sample(before=range(7)) == first
    others = [sample(seed=2), sample(sensor="other"), sample(quantity="x"), sample(number=8)]
    assert all(other != first for other in others)


def test_a_moved_generator_draws_what_a_new_one_draws():
    moved = SampleGenerator(1, "s", "q")
    for sample in (3, 0, (1 << 63) + 5, -2, 3):
        own = sample_generator(1, "s", "q", sample)
        assert moved.at(sample).normal(size=5).tolist() == own.normal(size=5).tolist()
        moved.at(sample, 2).integers(10, dtype=np.uint32)   # leaves half a number in its buffer
    # NumPy's own generator at that counter.
    key = moved._state["state"]["key"]
    counter = np.array([0, 0, 7, 2], dtype=np.uint64)
    plain = np.random.Generator(np.random.Philox(key=key, counter=counter))
    assert moved.at(7, 2).random(9).tolist() == plain.random(9).tolist()


def test_single_values_are_floats_and_what_is_not_finite_stays():
    noise = Noise(NoiseSpec("gaussian", 1.0, 0.0), 1, "s")
    assert noise.apply(2.0, 0, 0.1) == 3.0 and isinstance(noise.apply(2.0, 0, 0.1), float)
    found = noise.apply(np.array([1.0, math.inf, -math.inf]), 0, 0.1)
    assert found.tolist() == [2.0, math.inf, -math.inf]


def test_a_bias_is_drawn_once_and_has_either_sign():
    biases = np.array([Noise(NoiseSpec("gaussian", bias_mean=1.0, bias_stddev=0.1), seed, "s").bias
                       for seed in range(2000)])
    assert (biases > 0).mean() == pytest.approx(0.5, abs=0.04)
    assert np.abs(biases).mean() == pytest.approx(1.0, abs=0.01)
    assert np.abs(biases).std() == pytest.approx(0.1, rel=0.06)
    noise = Noise(NoiseSpec("gaussian", bias_mean=1.0), 3, "s")
    assert noise.apply(0.0, 0, 0.1) == noise.apply(0.0, 1, 0.1) == noise.bias


def test_a_negative_deviation_is_none():
    spec = NoiseSpec("gaussian", stddev=-1.0, bias_mean=0.5, bias_stddev=-1.0)
    assert abs(Noise(spec, 1, "imu").bias) == 0.5


def test_a_wandering_bias_has_its_deviation_and_its_correlation_time():
    spec = NoiseSpec("gaussian", dynamic_bias_stddev=0.1, dynamic_bias_correlation_time=2.0)
    noise = Noise(spec, 1, "s")
    walk = np.array([noise.apply(0.0, n, 0.5) for n in range(8000)])[100:]
    # Gazebo's: stationary deviation = stddev sqrt(tau / 2); correlation exp(-t / tau).
    assert walk.std() == pytest.approx(0.1 * math.sqrt(2.0 / 2.0), rel=0.06)
    assert np.corrcoef(walk[:-4], walk[4:])[0, 1] == pytest.approx(math.exp(-1.0), abs=0.06)
    noise.reset()
    assert noise.apply(0.0, 0, 0.5) == Noise(spec, 1, "s").apply(0.0, 0, 0.5)


def test_a_bias_that_wanders_leaves_where_it_was_drawn():
    spec = NoiseSpec("gaussian", bias_mean=5.0, dynamic_bias_stddev=1e-9,
                     dynamic_bias_correlation_time=2.0)
    noise = Noise(spec, 1, "s")
    assert abs(noise.bias) == 5.0
    assert noise.apply(0.0, 0, 2.0) == pytest.approx(noise.bias * math.exp(-1.0), rel=1e-6)
    assert noise.apply(0.0, 1, 60.0) == pytest.approx(0.0, abs=1e-6)
    noise.reset()
    assert noise.apply(0.0, 2, 2.0) == pytest.approx(noise.bias * math.exp(-1.0), rel=1e-6)


@pytest.mark.parametrize("name", ["gaussian", "gaussian_quantized"])
def test_values_with_a_precision_are_multiples_of_it(name):
    noise = Noise(NoiseSpec(name, 0.0, 0.3, precision=0.25), 1, "s")
    found = noise.apply(np.zeros(1000), 0, 0.1) / 0.25
    assert (found == np.rint(found)).all() and len(set(found)) > 4
    exact = Noise(NoiseSpec("gaussian_quantized", precision=0.1), 1, "s")
    assert exact.apply(np.array([0.05, -0.05, 0.149]), 0, 0.1) == pytest.approx([0.1, -0.1, 0.1])


def test_image_noise_is_grey_and_stays_within_a_byte():
    grey = np.full((200, 200, 3), 128, dtype=np.uint8)
    found = noisy_picture(grey, NoiseSpec("gaussian", 0.0, 0.05), 1, "cam", 0)
    assert (found[..., 0] == found[..., 1]).all() and found.dtype == np.uint8
    assert (found[..., 0].astype(float) - 128).std() == pytest.approx(0.05 * 255, rel=0.03)
    white = np.full((50, 50, 3), 250, dtype=np.uint8)
    assert noisy_picture(white, NoiseSpec("gaussian", 0.0, 0.1), 1, "cam", 0).max() == 255
    assert noisy_picture(grey, NoiseSpec(), 1, "cam", 0) is grey
