//! A small campaign in a temporary folder: scans of a few sines, a rubber and a recipe, which a
//! test edits.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Reads scans of 8 mm, fits three waves of 0.5 to 2 mm and solves on grids of a few hundred points:
/// a tenth of a second.
const RECIPE: &str = r##"title = "Small campaign"

[ingest]
scans = ["scans"]

[ingest.text]
separator = "semicolon"
comment = "#"
x_column = "x_mm"
x_unit = "mm"
z_column = "z_um"
z_unit = "um"
missing = ["BAD"]

[ingest.conditioning]
form = "slope"

[characterise]

[approximate]
waves = [2, 3]
shortest_wavelength_mm = 0.5

[realise]
waves = [3]
realisations = 2
seed = 1

[bem]
rubber = "rubber.toml"
speeds_mm_s = [10.0]
area_fractions = [0.02, 0.05, 0.1]
tolerance = 5e-3
points_per_shortest_wavelength = 16
"##;

const RUBBER: &str = r#"name = "tread"
equilibrium_modulus_mpa = 4.0
poisson_ratio = 0.49

[[branches]]
modulus_mpa = 8.0
relaxation_time_s = 1e-3

[[branches]]
modulus_mpa = 200.0
relaxation_time_s = 1e-5
"#;

/// Folder with `recipe.toml`, `rubber.toml` and three files in `scans`.
pub struct Campaign {
    folder: tempfile::TempDir,
}

impl Campaign {
    pub fn new() -> Self {
        let campaign = Self { folder: tempfile::tempdir().unwrap() };
        std::fs::create_dir(campaign.path("scans")).unwrap();
        campaign.write("recipe.toml", RECIPE);
        campaign.write("rubber.toml", RUBBER);
        for scan in 0..3 {
            campaign.write(&format!("scans/track_{scan}.txt"), &scan_text(scan));
        }
        campaign
    }

    /// The root folder.
    pub fn root(&self) -> &Path {
        self.folder.path()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.root().join(name)
    }

    pub fn write(&self, name: &str, text: &str) {
        std::fs::write(self.path(name), text).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// Replaces a text that must be there once.
    pub fn edit(&self, name: &str, from: &str, to: &str) {
        let text = self.read(name);
        assert_eq!(text.matches(from).count(), 1, "`{from}` in {name}");
        self.write(name, &text.replace(from, to));
    }

    /// The binary in the root folder, with arguments separated by blanks.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
        command.args(arguments.split_whitespace()).current_dir(self.root());
        command
    }
}

/// Three sines whose phases differ from scan to scan, on a tilt, with missing points.
fn scan_text(scan: u32) -> String {
    let mut text = String::from("# made by a test\nx_mm;z_um\n");
    for i in 0..320 {
        let x = 0.025 * f64::from(i);
        if (i + 7 * scan).is_multiple_of(53) {
            text += &format!("{x:.3};BAD\n");
            continue;
        }
        let wave = |wavelength: f64, amplitude: f64, turn: f64| {
            amplitude * (TAU * (x / wavelength + turn * f64::from(scan + 1))).sin()
        };
        let z =
            400.0 + 12.0 * x + wave(0.5, 8.0, 0.17) + wave(1.0, 15.0, 0.29) + wave(2.0, 30.0, 0.41);
        text += &format!("{x:.3};{z:.3}\n");
    }
    text
}
