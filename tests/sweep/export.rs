//! Tables keyed by what the sweep lists.

use super::{alone, campaign, quietly};
use asperity::artifact::read_table;
use asperity::stages::tables::FrictionRow;
use asperity::sweep::SweepFrictionRow;

#[test]
fn the_rows_are_those_of_the_cases_with_their_keys() {
    let campaign = campaign();
    alone(&campaign);
    let path = campaign.path("alone/sweep/friction.arrow");
    let (rows, _) = read_table::<SweepFrictionRow>(&path).unwrap();
    // Eight cases, two speeds, three areas.
    assert_eq!(rows.len(), 48);
    let own: Vec<_> = rows
        .iter()
        .filter(|row| {
            row.specimen.as_deref() == Some("B") && row.temperature_c == Some(40.0) && row.seed == 2
        })
        .map(|row| row.friction.clone())
        .collect();
    let case =
        campaign.path("alone/cases/specimen=B/temperature_c=40/seed=2/tables/friction.arrow");
    assert_eq!(read_table::<FrictionRow>(&case).unwrap().0, own);
    // Hotter rubber is softer, shifted to lower frequencies: another friction.
    let mean = |celsius: f64| {
        let of: Vec<f64> = rows
            .iter()
            .filter(|row| row.temperature_c == Some(celsius))
            .map(|row| row.friction.mean)
            .collect();
        of.iter().sum::<f64>() / of.len() as f64
    };
    assert!((mean(10.0) / mean(40.0) - 1.0).abs() > 0.1);
}

#[test]
fn a_sweep_is_exported_whole() {
    let campaign = campaign();
    alone(&campaign);
    let csv = quietly(&campaign, "export alone --format csv").result();
    assert!(csv.starts_with("specimen,rubber,temperature_c,seed,model,method,waves"), "{csv}");
    assert_eq!(csv.lines().count(), 49);
    let markdown = quietly(&campaign, "export alone --format markdown --speed 50").result();
    assert_eq!(markdown.matches("## specimen ").count(), 8);
    assert!(markdown.contains("## specimen A, rubber rubber at 10 °C, seed 1"), "{markdown}");
    assert!(!markdown.contains("10 mm/s"));
    assert!(quietly(&campaign, "export alone --format latex").result().contains("\\toprule"));
    quietly(&campaign, "export alone --format parquet --to sweep.parquet").result();
    assert!(quietly(&campaign, "export alone --format svg").error(2).contains("cases/"));
}
