//! What a laboratory asks of the road that it scanned: which run has more friction, and down to which wavelength.

use super::Outcome;
use super::common::Campaign;

fn outcome(campaign: &Campaign, arguments: &str) -> Outcome {
    Outcome::of(&mut campaign.command(arguments))
}

const RUN: &str = "run recipe.toml --out out --quiet";

/// The small campaign with its measured profiles at two speeds and a pressure.
fn measured() -> Campaign {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[realise]", "[realise]\nmethods = [\"measured\", \"sines\"]");
    campaign.edit("recipe.toml", "[10.0]", "{ from = 1, to = 100, per_decade = 1 }");
    campaign.edit(
        "recipe.toml",
        "area_fractions = [0.02, 0.05, 0.1]",
        "area_fractions = []\npressures_mpa = [0.3]",
    );
    campaign
}

#[test]
fn captions_say_what_was_computed() {
    let campaign = measured();
    outcome(&campaign, RUN).result();
    let text =
        outcome(&campaign, "export out --format markdown --method measured --speed 10").result();
    for part in [
        "over mean pressure",
        "measured profiles of 3 windows",
        "waves from 0.5",
        "10 mm/s",
        "contact area fraction",
        "rubber tread",
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(text.contains("| pressure_mpa | contact_area_fraction |"), "{text}");
    let ratios = outcome(&campaign, "export out --format csv --table tables/methods").result();
    assert_eq!(ratios.lines().count(), 1 + 2 * 3);
    for figure in ["methods", "speed", "budget"] {
        let svg = outcome(&campaign, &format!("plot {figure} out")).result();
        assert!(svg.contains("rubber tread") && svg.contains("</svg>"), "{figure}");
    }
    let report = {
        outcome(&campaign, "report out --to report.html --quiet").result();
        campaign.read("report.html")
    };
    assert!(report.contains("its ratio to that of the measured profiles</caption>"));
    assert!(report.contains("what would reduce it"));
}

#[test]
fn two_runs_are_compared_by_what_they_share() {
    let campaign = measured();
    outcome(&campaign, RUN).result();
    let rubber = campaign.read("rubber.toml");
    campaign.write("softer.toml", &rubber.replace("modulus_mpa = 200.0", "modulus_mpa = 400.0"));
    campaign
        .write("other.toml", &campaign.read("recipe.toml").replace("rubber.toml", "softer.toml"));
    outcome(&campaign, "run other.toml --out other --quiet").result();
    let compared = outcome(&campaign, "compare out other --json --to difference.svg");
    let json: serde_json::Value = serde_json::from_str(&compared.result()).unwrap();
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 6);
    for row in rows {
        // Another rubber on the same surfaces.
        assert_eq!(row["pairing"], "paired");
        assert!(row["difference"].as_f64().unwrap() > 0.0 && row["confidence_95"].is_number());
    }
    assert!(campaign.read("difference.svg").contains("difference of friction"));
    let text = outcome(&campaign, "compare out other").result();
    assert!(text.contains("measured profiles") && text.contains("verdict"), "{text}");
    let itself = outcome(&campaign, "compare out out").result();
    assert!(itself.contains("not told apart") && !itself.contains("B by"), "{itself}");
    let missing = outcome(&campaign, "compare out nowhere").error(2);
    assert!(missing.contains("nowhere"), "{missing}");
}

#[test]
fn friction_is_shown_over_the_shortest_wavelength() {
    let campaign = measured();
    let cutoff = "cutoff recipe.toml --octaves 3 --out out --quiet";
    let found = outcome(&campaign, &format!("{cutoff} --json --to cutoff.svg")).result();
    let json: serde_json::Value = serde_json::from_str(&found).unwrap();
    let rows = json["rows"].as_array().unwrap();
    // Two shortest wavelengths at three speeds: from 2 mm on no window holds four waves.
    assert_eq!(rows.len(), 2 * 3 * 2);
    for line in rows.chunks(2) {
        let shortest = |k: usize| line[k]["shortest_wavelength_mm"].as_f64().unwrap();
        assert!((shortest(0) / shortest(1) - 2.0).abs() < 0.1, "{line:?}");
        assert!(line[0]["growth"].is_null() && line[1]["growth"].is_number());
    }
    assert!(campaign.read("cutoff.svg").contains("shortest wavelength"));
    // The second time nothing is computed.
    assert_eq!(outcome(&campaign, &format!("{cutoff} --json")).result(), found);
    let sweep =
        campaign.read("recipe.toml").replace("seed = 1\n", "") + "\n[sweep]\nseeds = [1, 2]\n";
    campaign.write("sweep.toml", &sweep);
    let refused = outcome(&campaign, "cutoff sweep.toml").error(2);
    assert!(refused.contains("[sweep]"), "{refused}");
}
