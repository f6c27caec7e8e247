"""What more than one command prints."""

PLAN = """\
plan 20261124T093012Z-k3f9q2aw  regrasp, trial 1
reason                          first plan of the experiment
believed                        mu 0.3800, kappa 20.65 m/s², rho 10.44 mm
object at the start of sliding  x -0.230 m/s, y 0.375 m/s, theta 0.000 rad/s

pose                            x mm    y mm  theta mrad
────────────────────────────────────────────────────────
finger on the object, before  -10.00  -20.00      3141.6
finger on the object, after    10.00   20.00      3141.6
hand in the plane, before     -10.00  -20.00      3141.6
hand in the plane, after       10.00   20.00      3141.6

phase       from s   to s  x m/s²  y m/s²  theta rad/s²  acceleration of
─────────────────────────────────────────────────────────────────────────────────
stick        0.000  0.300  -0.765   1.250         0.000  the object in the plane
slide        0.300  0.460       -       -             -  the object in the plane
  starting   0.300  0.380   3.125   6.250         0.000  the finger on the object
  braking    0.380  0.460  -3.125  -6.250         0.000  the finger on the object
settle       0.460  1.260   0.500  -2.000         0.000  the object in the plane

limit                                                         reached    bound  used   at s
───────────────────────────────────────────────────────────────────────────────────────────
share of the friction used while sticking before the slide     0.8123        1  81 %  0.298
hand speed                                                  1.235 m/s    3 m/s  41 %  0.380
elbow speed                                                   0.5 m/s  2.5 m/s  20 %  0.400
joint 7 torque                                                  7 N m   10 N m  70 %  0.300
joint 6 torque                                                  6 N m   10 N m  60 %  0.300
joint 5 torque                                                  5 N m   10 N m  50 %  0.300
joint 4 torque                                                  4 N m   10 N m  40 %  0.300
joint 3 torque                                                  3 N m   10 N m  30 %  0.300

data/runs/2026-11-24/20261124T093012Z-k3f9q2aw/plan.yaml
"""
