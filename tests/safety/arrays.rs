//! Damaged files of arrays, which the HDF5 library reads or crashes on.

use std::fs;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{finished, quietly};

const FLIPS: usize = 300;

/// Away from its manifest the file is anybody's. An exit by a signal has no code, and fails in `Outcome::of`.
#[test]
fn no_flipped_byte_takes_inspect_down() {
    let campaign = finished();
    let whole = fs::read(campaign.path("out/ingest/scans.h5")).unwrap();
    let told = quietly(&campaign, "inspect out/ingest/scans.h5 --json").json();
    let mut rng = Pcg64::seed_from_u64(13);
    let (mut crashes, mut same) = (0, 0);
    for flip in 0..FLIPS {
        let mut bytes = whole.clone();
        // Half of them in the first kilobytes, where the structure of the file is.
        let among = if flip % 2 == 0 { bytes.len() } else { 4096.min(bytes.len()) };
        let place = rng.random_range(0..among);
        bytes[place] ^= 1 << rng.random_range(0..8);
        fs::write(campaign.path("foreign.h5"), bytes).unwrap();
        let outcome = quietly(&campaign, "inspect foreign.h5 --json");
        match outcome.code {
            // Room that the format leaves free, or a text that no digest covers.
            0 => same += 1,
            2 => {
                assert!(outcome.stderr.contains("foreign.h5"), "{place}: {}", outcome.stderr);
                crashes += usize::from(outcome.stderr.contains("library crashed"));
            }
            code => panic!("byte {place}: exit code {code}: {}", outcome.stderr),
        }
    }
    eprintln!("{FLIPS} flips: {same} without effect, the library crashed on {crashes}");
    assert!(same < 2 * FLIPS / 3, "{same}");
    assert_eq!(told["kind"], "arrays");
}

/// The bytes are compared before the library sees them, on every way into a run folder.
#[test]
fn damaged_arrays_of_a_run_are_named_by_every_command() {
    let campaign = finished();
    let path = campaign.path("out/bem/fields.h5");
    let whole = fs::read(&path).unwrap();
    let mut rng = Pcg64::seed_from_u64(14);
    for _ in 0..12 {
        let mut bytes = whole.clone();
        let place = rng.random_range(0..4096.min(bytes.len()));
        bytes[place] ^= 1 << rng.random_range(0..8);
        fs::write(&path, bytes).unwrap();
        let verified = quietly(&campaign, "verify out");
        assert_eq!(verified.code, 1);
        assert!(verified.stdout.contains("fields.h5"), "{}", verified.stdout);
        let status = quietly(&campaign, "status recipe.toml --out out");
        assert!(status.stdout.contains("fields.h5"), "{place}: {}", status.stdout);
        let plotted = quietly(&campaign, "plot pressure out");
        assert!(plotted.code != 0 && plotted.stderr.contains("fields.h5"), "{}", plotted.stderr);
    }
    quietly(&campaign, "run recipe.toml --out out").result();
    assert_eq!(fs::read(&path).unwrap(), whole);
}
