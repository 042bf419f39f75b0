//! The reliability cut-off from the recipe to the friction table, and the check of the spectrum.

use super::{Campaign, recipe, run};
use asperity::artifact::RunView;
use asperity::stages;
use asperity::stages::approximate::FITS;
use asperity::stages::characterise::{
    AGREEMENT, AVERAGE, CORRELATION, HURST, HurstMethod, HurstRow, LARGEST_DIFFERENCE_KEY,
    RELIABLE_KEY, SPECTRUM,
};
use asperity::stages::tables::FRICTION;
use std::collections::BTreeSet;

#[test]
fn the_spot_reaches_the_ladder_and_the_friction_table() {
    let campaign = Campaign::new();
    let spot = "[characterise]\nspot_diameter_um = 400.0";
    campaign.edit("recipe.toml", "[characterise]", spot);
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let (rows, metadata) = view.read_table(CORRELATION).unwrap();
    assert!(!rows.is_empty());
    assert_eq!(metadata[RELIABLE_KEY].parse::<f64>().unwrap(), 0.8);
    // The ladder begins at 0.5 mm: its first wave is left out.
    let fits = view.rows(FITS).unwrap();
    for fit in &fits {
        assert_eq!(fit.waves_fitted, fit.waves - 1);
        assert!(fit.warnings.contains("instrument (0.800000 mm); left out"), "{}", fit.warnings);
    }
    let friction = view.rows(FRICTION).unwrap();
    assert!(!friction.is_empty());
    assert!(friction.iter().all(|row| row.shortest_reliable_wavelength_mm == Some(0.8)));
}

#[test]
fn conventions_and_the_cosine_check_stand_in_the_artifacts() {
    let campaign = Campaign::new();
    let window = "[characterise]\nspectrum_window = \"welch\"";
    campaign.edit("recipe.toml", "[characterise]", window);
    let out = campaign.path("out");
    run(&recipe(&campaign), &out);
    let view = RunView::of(&out);
    let (rows, metadata) = view.read_table(SPECTRUM).unwrap();
    assert!(rows.iter().all(|row| row.standard_error_mm3 >= 0.0));
    assert_eq!(metadata["window"], "welch");
    assert!(metadata["sides"].starts_with("one-sided"));
    let (rows, metadata) = view.read_table(AGREEMENT).unwrap();
    let largest: f64 = metadata[LARGEST_DIFFERENCE_KEY].parse().unwrap();
    let found = rows.iter().map(|row| row.relative_difference.abs()).fold(0.0, f64::max);
    assert_eq!(found, largest);
    let warnings =
        view.stage_manifest(stages::characterise::STAGE.name()).unwrap().unwrap().warnings;
    let warned = warnings.iter().any(|warning| warning.contains("correlation differ"));
    assert_eq!(warned, largest > 0.1);
    let rows = view.rows(HURST).unwrap();
    assert!(rows.iter().any(|row| row.scan == AVERAGE && row.method == HurstMethod::Correlation));
    // The exponents of a window stand beneath each other, those of the average last.
    let scans: Vec<&str> =
        rows.chunk_by(|a, b| a.scan == b.scan).map(|rows| rows[0].scan.as_str()).collect();
    assert_eq!(scans.iter().collect::<BTreeSet<_>>().len(), scans.len(), "{scans:?}");
    let spectrum_first =
        |pair: &[HurstRow]| pair[0].scan == pair[1].scan && pair[0].method == HurstMethod::Spectrum;
    assert!(!rows.windows(2).any(spectrum_first));
    assert_eq!(rows.last().unwrap().scan, AVERAGE);
}
