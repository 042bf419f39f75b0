//! Extreme numbers, and input that is refused.

use super::*;

#[test]
fn odd_prime_and_oblong_grids_with_unequal_spacings_converge() {
    let rubber = Rubber::table_2_1();
    for (points, periods) in [
        ([61, 47], [1e-3, 1e-3]),
        ([97, 32], [1e-3, 0.2e-3]),
        ([64, 131], [0.7e-3, 2e-3]),
        ([150, 2], [1e-3, 1e-4]),
        ([3, 200], [1e-5, 1e-3]),
    ] {
        let heights = rough(points, 6, 0.2);
        let mut areal = contact(&rubber, 0.02, 0.5, &heights, points, periods);
        for pressure in [1e4, 1e6] {
            let solution = areal.solve(pressure).unwrap();
            assert_complementary(&solution);
        }
    }
}
