from cli import pooled_samples, samples

PRINTED = """\
pooled 20261124T093050Z-p00xedx1  regrasp, 2 trials
final minus goal            x mm    y mm  theta mrad  kappa m/s²    ±
────────────────────────────────────────────────────────────────────────────────────────
20261124T093015Z-m0x7c4td  -6.00  -11.90         1.0        23.1  0.1  stands out: error
20261124T093016Z-m0x7c4te      -       -           -           -    -

mean                       -6.00  -11.90         1.0                   of 1 trial

kappa = mu f_N / m      23.1 ± 1.2 m/s², 95 % interval [20.6, 25.9] m/s²
noise within a trial    0.1 m/s² (0.43 %)
spread between trials   0.9 m/s² (3.9 %), 95 % interval [0.05, 4.1] m/s²
one value for all       one trial cannot say
the next trial's kappa  95 % interval [19.5, 27.3] m/s²
mu                      0.4250, 95 % interval [0.3790, 0.4766]
assumed for mu          f_N 1.25 N, mass 23 g, rho 10.44 mm
left out                20261124T093016Z-m0x7c4te: poses: 3 frames with the bodies in them
note                    one trial tells little

data/runs/2026-11-24/20261124T093050Z-p00xedx1/pooled.yaml
data/runs/2026-11-24/20261124T093050Z-p00xedx1/repeatability.png
"""


def test_pooled(call) -> None:
    result = call("estimate", "x", "y")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout == PRINTED


def test_pooled_without_friction(call, stages) -> None:
    stages.answers["pool"].document = pooled_samples.pooled(friction=False)
    result = call("estimate", "x", "y")
    assert result.exit_code == 1
    assert result.stderr == "friction: none of the trials tells it\n"
    assert "friction  not estimated: none of the trials tells it\n" in result.stdout
    assert "the object did not slide" in result.stdout


def test_a_pooled_run_is_shown_again(call, publish) -> None:
    run = samples.run(pooled_samples.POOLED, "pool", outputs=(samples.output("pooled", "pooled.yaml"),))
    publish(run, pooled=pooled_samples.pooled())
    assert PRINTED in call("show", "@latest:pool").stdout
