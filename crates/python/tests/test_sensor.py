"""Pictures of photons: the photon transfer curve, with numpy's own Poisson numbers as the witness."""

import numpy as np
import pytest

import bilux

PLAIN = dict(pattern="mono", output="raw", gain=0.1, full_well=20_000, dark_current=0, read_noise=4, black_level=50)
PHOTONS_PER_RADIANCE = np.pi / (4 * 2.8**2) * 3.45e-6**2 * 0.01 * 555e-9 / (6.62607015e-34 * 299792458)


def grey(radiance, side=256):
    return bilux.Picture(np.full((side, side), radiance, np.float32))


def test_the_photon_transfer_curve_has_the_gain_as_its_slope():
    means, variances = [], []
    for level, electrons in enumerate(np.linspace(200, 15_000, 12)):
        raw = grey(electrons / 0.6 / PHOTONS_PER_RADIANCE).sensor(seed=level, **PLAIN).pixels.astype(float)
        means.append(raw.mean() - 50)
        variances.append(raw.var())
    # Variances of more light are less certain.
    slope, intercept = np.polyfit(means, variances, 1, w=1 / np.array(variances))
    assert slope == pytest.approx(0.1, rel=0.01)
    assert intercept == pytest.approx(0.1**2 * 4**2 + 1 / 12, abs=0.08)
    assert np.allclose(means, 0.1 * np.linspace(200, 15_000, 12), rtol=2e-3)


@pytest.mark.parametrize("electrons", [0.4, 4.2, 60.0, 3000.0])
def test_electrons_are_distributed_as_numpys_poisson_numbers(electrons):
    exact = PLAIN | dict(gain=1, read_noise=0, bit_depth=16, black_level=0)
    ours = grey(electrons / 0.6 / PHOTONS_PER_RADIANCE).sensor(**exact).pixels.ravel().astype(int)
    theirs = np.random.default_rng(5).poisson(electrons, ours.size)
    assert distance(ours, theirs) < 4.5
    # A normal number of the same moments is none, as long as there are few.
    if electrons < 100:
        rounded = np.random.default_rng(6).normal(electrons, np.sqrt(electrons), ours.size).round().clip(0).astype(int)
        assert distance(rounded, theirs) > 4.5


def distance(ours, theirs):
    """How far two samples are from one distribution, by a χ² of cells that have enough in them, in standard deviations."""
    edges = np.unique(np.quantile(theirs, np.linspace(0, 1, 40)).astype(int))
    edges = np.concatenate([[-1], edges, [10**9]])
    a, b = (np.histogram(numbers, edges + 0.5)[0] for numbers in (ours, theirs))
    some = a + b > 20
    statistic = (((a - b) ** 2)[some] / (a + b)[some]).sum()
    return (statistic - some.sum()) / np.sqrt(2 * some.sum())


def test_a_rendered_picture_becomes_a_photograph():
    light = bilux.generate("cornell").render(size=64, spp=16, integrator="path", denoise=False)
    shot = light.sensor(exposure_time=0.002, iso=400, seed=3)
    assert shot.info["iso"] == pytest.approx(400) and shot.info["gain"] > 0
    bright = light.pixels[..., :3].max(axis=2) * 683 < shot.info["saturating_luminance"] / 3
    assert bright.sum() > 1000
    assert shot.pixels[bright].mean() == pytest.approx(light.pixels[bright].mean(), rel=0.05)
    again = light.sensor(exposure_time=0.002, iso=400, seed=3)
    assert np.array_equal(shot.pixels, again.pixels)
    assert not np.array_equal(shot.pixels, light.sensor(exposure_time=0.002, iso=400, seed=4).pixels)


def test_candela_are_the_same_light():
    watts = grey(0.2).sensor(**PLAIN).pixels
    candela = grey(0.2 * 683).sensor(unit="cd/m2", **PLAIN).pixels
    assert np.abs(watts - candela).mean() < 0.01


def test_the_command_line_reads_the_same_numbers(command_line, folder):
    light = bilux.generate("cornell").render(size=32, spp=4, integrator="path", denoise=False)
    light.save("light.exr")
    light = bilux.read_picture("light.exr")
    raw = light.sensor(iso=100, exposure_time=0.05, seed=9, output="raw").pixels
    words = ["--iso", 100, "--exposure-time", 0.05, "--seed", 9, "--output-kind", "raw"]
    command_line("sensor", "light.exr", "-o", "raw.png", *words)
    command_line("sensor", "light.exr", "-o", "raw.exr", *words)
    assert np.array_equal(bilux.read_picture("raw.exr").pixels, raw)
    # Whoever reads a PNG as light decodes it; its integers are the numbers.
    light = bilux.read_picture("raw.png").pixels.astype(float)
    numbers = np.where(light <= 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055) * 65535
    assert np.array_equal(np.rint(numbers), raw)


def test_what_makes_no_sense_is_refused():
    with pytest.raises(bilux.SceneError, match="f_number"):
        grey(1).sensor(f_number=0)
    with pytest.raises(bilux.SceneError, match="exposure_time"):
        grey(1).sensor(exposure_tine=1)
    with pytest.raises(bilux.SceneError, match="pattern"):
        grey(1).sensor(pattern="rgbw")
    with pytest.raises(bilux.PictureError, match="black level"):
        grey(1).sensor(bit_depth=8, black_level=255)


def test_iso_and_gain_are_not_both_taken():
    light = bilux.generate("cornell").render(size=8, spp=1)
    with pytest.raises(bilux.SceneError, match="gain: iso and gain both set"):
        light.sensor(iso=100, gain=2)
    assert light.sensor(iso=400, gain=0).info["iso"] == pytest.approx(400)
    assert light.sensor(iso=0, gain=2).info["gain"] == pytest.approx(2)
