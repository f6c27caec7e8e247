"""A fitted surface with numbers that a test can look for."""

from slidepipe.artifacts.surface import Ellipsoid, SlidingDirectionError, SupportFriction, SurfaceDocument

SURFACE = "20261124T093100Z-5vrfacex"


def surface(*, supports: int = 2, given: bool = False) -> SurfaceDocument:
    return SurfaceDocument(
        name="block",
        pairs=50,
        shares_given=given,
        friction_n=4.4598,
        friction_std_n=0.114,
        supports=tuple(
            SupportFriction(x_m=-0.02, y_m=0.01 * place, share=1.0 / supports, share_std=0.0 if given else 0.03)
            for place in range(supports)
        ),
        rms_force_n=1.127,
        rms_moment_n_m=0.04558,
        arm_m=0.03924,
        ellipsoid=Ellipsoid(friction_n=4.303, rho_m=0.04143),
        exact_direction_error=SlidingDirectionError(median_rad=0.159, ninth_decile_rad=0.454),
        ellipsoid_direction_error=SlidingDirectionError(median_rad=0.244, ninth_decile_rad=0.459),
        models_apart=SlidingDirectionError(median_rad=0.195, ninth_decile_rad=0.33),
    )
