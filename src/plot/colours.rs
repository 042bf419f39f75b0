//! Colours of values: dark blue for the least, yellow for the largest, with a lightness that grows evenly, so that they can be
//! told apart with colour-vision deficiencies and in print without colours.

/// Where there is no value.
pub(super) const NOTHING: [u8; 3] = [234, 234, 234];

/// Colours at equal steps, those of viridis (S. van der Walt and N. Smith, 2015). The last yellow is left out: it is as light as
/// the grey of no value.
const CONTROL: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 144, 140],
    [39, 173, 129],
    [93, 200, 99],
    [170, 220, 50],
    [216, 226, 25],
];

/// The colour of a share from 0 to 1, between its neighbours in the table in the perceptual space Oklab.
pub(super) fn of_share(share: f64) -> [u8; 3] {
    let position = share.clamp(0.0, 1.0) * (CONTROL.len() - 1) as f64;
    let left = (position as usize).min(CONTROL.len() - 2);
    let weight = position - left as f64;
    let (from, to) = (oklab(CONTROL[left]), oklab(CONTROL[left + 1]));
    srgb([0, 1, 2].map(|i| from[i] + weight * (to[i] - from[i])))
}

/// Lightness and two opponent colours (B. Ottosson, 2020).
fn oklab(colour: [u8; 3]) -> [f64; 3] {
    let linear = |value: u8| {
        let value = f64::from(value) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    };
    let [r, g, b] = colour.map(linear);
    let l = (0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b).cbrt();
    let m = (0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b).cbrt();
    let s = (0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b).cbrt();
    [
        0.210_454_255_3 * l + 0.793_617_785_0 * m - 0.004_072_046_8 * s,
        1.977_998_495_1 * l - 2.428_592_205_0 * m + 0.450_593_709_9 * s,
        0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766_0 * s,
    ]
}

fn srgb([lightness, a, b]: [f64; 3]) -> [u8; 3] {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    let linear = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ];
    linear.map(|value| {
        let value = value.clamp(0.0, 1.0);
        let encoded = if value <= 0.003_130_8 {
            12.92 * value
        } else {
            1.055 * value.powf(1.0 / 2.4) - 0.055
        };
        (255.0 * encoded).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lightness_grows_evenly() {
        let lightness: Vec<f64> =
            (0..=64).map(|k| oklab(of_share(f64::from(k) / 64.0))[0]).collect();
        let mean = (lightness[64] - lightness[0]) / 64.0;
        let steps = lightness.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(steps.clone().all(|step| step > 0.2 * mean && step < 2.0 * mean), "{lightness:?}");
        assert!(lightness[64] < oklab(NOTHING)[0] - 0.03);
    }

    #[test]
    fn the_table_is_met() {
        for (k, colour) in CONTROL.iter().enumerate() {
            assert_eq!(of_share(k as f64 / 8.0), *colour);
        }
        assert_eq!((of_share(-1.0), of_share(f64::INFINITY)), (CONTROL[0], CONTROL[8]));
    }
}
