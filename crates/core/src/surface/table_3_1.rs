//! The waves of the published tables.

/// Wavelength and amplitude in mm of the eight superposed sines of the thesis (Table 3.1), the shortest first.
pub const TABLE_3_1_MM: [(f64, f64); 8] = [
    (0.0625, 0.01867),
    (0.125, 0.02648),
    (0.25, 0.02939),
    (0.5, 0.06626),
    (1.0, 0.06177),
    (2.0, 0.21635),
    (4.0, 0.14772),
    (8.0, 0.48995),
];
