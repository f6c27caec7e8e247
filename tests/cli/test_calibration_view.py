import json
from pathlib import Path

from cli import calibration_samples, samples
from slidepipe.artifacts.store import Store

PRINTED = """\
calibration 20261124T093200Z-ca7brat0  from trial 20261124T093015Z-m0x7c4td
± one standard deviation                         x               y              z
─────────────────────────────────────────────────────────────────────────────────
cameras in the base frame, mm       1199.76 ± 4.18  -399.95 ± 0.09  300.00 ± 0.12
  turned by, mrad                     1200.0 ± 0.1    -700.0 ± 0.2   2000.0 ± 0.2
hand's markers in {f}, mm             11.97 ± 0.02   -20.03 ± 0.03   29.70 ± 4.18
  turned by, mrad                      300.0 ± 0.1    -200.0 ± 0.2    800.0 ± 0.2
tilt of the object's markers, mrad     -16.4 ± 0.3     -11.7 ± 0.2      0.0 ± 0.0

motion plane               heading 1570.9 mrad, leans by -1.3 mrad, each ± 0.3
down for the cameras       [-0.8991, 0.0957, -0.4271] ± 0.2 mrad
joints behind the cameras  -0.024 ± 0.013 ms
the hand turned by         157.1 degrees
left between them          0.30 mm and 3.0 mrad rms in 598 frames, 1 left out
note                       the base is taken to stand level

data/runs/2026-11-24/20261124T093200Z-ca7brat0/calibration.yaml
"""


def test_calibrate(call, stages) -> None:
    result = call("calibrate", "m0x7", "--force")
    assert (result.exit_code, result.stderr, result.stdout) == (0, "", PRINTED)
    (request,) = stages.requests
    assert vars(request) == {
        "trial": "m0x7",
        "store": Store(Path("data")),
        "force": True,
        "command": ("slidepipe", "calibrate", "m0x7", "--force"),
    }


def test_calibration_without_an_object(call, stages) -> None:
    stages.answers["calibrate"].document = calibration_samples.calibration(tilt=False)
    assert "object's markers" not in call("calibrate", "m0x7").stdout


def test_calibration_as_one_object(call) -> None:
    told = json.loads(call("calibrate", "x", "--json").stdout)
    assert list(told) == ["schema", "run", "directory", "reused", "document"]
    assert (told["schema"], told["document"]["schema"]) == ("slidepipe.calibrate_result/1", "slidepipe.calibration/1")


def test_a_calibration_is_shown_again(call, publish) -> None:
    run = samples.run(
        calibration_samples.CALIBRATION, "calibrate", outputs=(samples.output("calibration", "calibration.yaml"),)
    )
    publish(run, calibration=calibration_samples.calibration())
    assert PRINTED in call("show", "@latest:calibrate").stdout
