//! `asperity report` and `plot`: what a document holds, what it must not hold, what is refused.

use std::fs;

use quick_xml::Reader;
use quick_xml::events::Event;

use super::Outcome;
use crate::common::Campaign;

const RUN: &str = "run recipe.toml --out out --quiet";

fn outcome(campaign: &Campaign, arguments: &str) -> Outcome {
    Outcome::of(&mut campaign.command(arguments))
}

/// A finished run with fields.
fn finished() -> Campaign {
    let campaign = Campaign::new();
    campaign.edit("recipe.toml", "[bem]\n", "[bem]\nfield_area_fractions = [0.05]\n");
    outcome(&campaign, RUN).result();
    campaign
}

fn report(campaign: &Campaign) -> String {
    outcome(campaign, "report out --to report.html --force --quiet").result();
    campaign.read("report.html")
}

/// Panics unless every element is closed; returns how many there are of a name.
fn elements(svg: &str, name: &str) -> usize {
    let mut reader = Reader::from_str(svg);
    let (mut count, mut depth) = (0, 0);
    loop {
        match reader.read_event().unwrap() {
            Event::Start(start) => {
                depth += 1;
                count += usize::from(start.name().as_ref() == name.as_bytes());
            }
            Event::Empty(empty) => count += usize::from(empty.name().as_ref() == name.as_bytes()),
            Event::End(_) => depth -= 1,
            Event::Eof => break,
            _ => {}
        }
    }
    assert_eq!(depth, 0);
    count
}

#[test]
fn a_report_has_everything_and_needs_nothing() {
    let campaign = finished();
    let page = report(&campaign);
    let sections = [
        "input",
        "heights",
        "correlation",
        "spectrum",
        "waves",
        "friction",
        "correction",
        "fields",
        "rubber",
        "tables",
        "accuracy",
        "provenance",
    ];
    for section in sections {
        assert_eq!(page.matches(&format!("<section id=\"{section}\"")).count(), 1, "{section}");
        assert!(page.contains(&format!("href=\"#{section}\"")), "{section}");
    }
    // Fields of the one realisation that is shown: over the period and close up.
    for (figure, panels) in [("scans", 1), ("friction", 1), ("pressure", 2), ("deformation", 2)] {
        let start = page.find(&format!("id=\"figure-{figure}\"")).unwrap();
        let end = start + page[start..].find("</figure>").unwrap();
        assert_eq!(page[start..end].matches("<svg").count(), panels, "{figure}");
    }
    assert!(page.contains("<title>Small campaign</title>"));
    // The recipe, the rubber, the version, the single numbers.
    assert!(page.contains("shortest_wavelength_mm = 0.5"));
    assert!(page.contains("Rubber tread") && page.contains(env!("CARGO_PKG_VERSION")));
    let friction = campaign.path("friction.csv");
    outcome(&campaign, &format!("export out --format csv --to {}", friction.display())).result();
    let average = |line: &str| line.split(',').nth(3).unwrap().parse::<f64>().unwrap();
    for line in campaign.read("friction.csv").lines().skip(1) {
        let average = average(line);
        let decimals = 3 - average.log10().floor() as i32;
        let shown = format!(">{average:.*}<", decimals.max(0) as usize);
        assert!(page.contains(&shown), "{shown} of {line}");
    }
    // Both Hurst exponents stand in one table, with the reason below, and nowhere else.
    assert_eq!(page.matches(">Hurst exponent H</th>").count(), 1);
    let caption =
        "Hurst exponent H of the average, from the correlation and from the spectrum</caption>";
    let (_, exponents) = page.split_once(caption).unwrap();
    let (columns, after) = exponents.split_once("</table>").unwrap();
    assert!(columns.contains(">correlation</th>") && columns.contains(">spectrum</th>"));
    assert!(after.trim_start_matches("</div>").starts_with("<p>The two differ because"));
    // No network, and no number that is none.
    let outside = ["src=", "@import", "<script", "url("];
    assert!(outside.iter().all(|asked| !page.contains(asked)));
    let links: Vec<&str> = page.split("href=\"").skip(1).collect();
    assert!(links.iter().all(|link| link.starts_with('#') || link.starts_with("data:,")));
    assert!(!page.contains("NaN") && !page.contains("inf<") && !page.contains(">-inf"));
    // The same run, the same document.
    assert_eq!(page, report(&campaign));
}

#[test]
fn names_of_others_are_text_and_no_markup() {
    let campaign = Campaign::new();
    let title = "<script>alert('1')</script> & \\\"quotes\\\"";
    campaign.edit("recipe.toml", "Small campaign", title);
    campaign.edit("rubber.toml", "tread", "<b>bold</b> & <i>");
    let hostile = campaign.path("scans/<img onerror=x> & y.txt");
    fs::rename(campaign.path("scans/track_1.txt"), hostile).unwrap();
    outcome(&campaign, RUN).result();
    let page = report(&campaign);
    for markup in ["<script", "<b>", "<i>", "<img"] {
        assert!(!page.contains(markup), "{markup}");
    }
    assert!(page.contains("&lt;script&gt;alert") && page.contains("&lt;b&gt;bold"));
    assert!(page.contains("&lt;img onerror=x&gt; &amp; y"));
    let svg = outcome(&campaign, "plot scans out").result();
    assert!(elements(&svg, "text") > 4);
}

#[test]
fn a_part_of_a_run_has_a_report_that_says_what_is_missing() {
    let campaign = Campaign::new();
    fs::create_dir(campaign.path("out")).unwrap();
    let empty = outcome(&campaign, "report out").error(2);
    assert!(empty.contains("out has no results of a run"), "{empty}");
    assert!(outcome(&campaign, "report nowhere").error(2).contains("nowhere"));

    for stage in ["ingest", "characterise"] {
        outcome(&campaign, &format!("{RUN} --only {stage}")).result();
    }
    let page = report(&campaign);
    assert!(page.contains("id=\"figure-correlation\"") && !page.contains("id=\"figure-friction\""));
    assert!(page.contains("No rubber was used in this run"));
    let friction = outcome(&campaign, "plot friction out").error(2);
    assert!(friction.contains("out has no figure `friction`: it needs"), "{friction}");
}

#[test]
fn results_that_the_recipe_no_longer_asks_for_are_marked() {
    let campaign = finished();
    campaign.edit("recipe.toml", "seed = 1", "seed = 2");
    let told = outcome(&campaign, "report out");
    assert_eq!(told.code, 0);
    assert!(
        told.stderr.contains("warning: ") && told.stderr.contains("report in"),
        "{}",
        told.stderr
    );
    assert!(campaign.read("out/report.html").contains("Not up to date"));
    let again = outcome(&campaign, "report out --quiet").error(2);
    assert!(again.contains("out/report.html") && again.contains("--force"), "{again}");
    let plotted = outcome(&campaign, "plot friction out --to friction.svg");
    assert_eq!(plotted.code, 0);
    assert!(plotted.stderr.contains("warning: "), "{}", plotted.stderr);
}

#[test]
fn a_damaged_result_is_named_and_not_shown() {
    let campaign = finished();
    let table = campaign.path("out/tables/friction.arrow");
    let mut bytes = fs::read(&table).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(&table, bytes).unwrap();
    for command in ["report out --quiet", "plot friction out --quiet"] {
        let message = outcome(&campaign, command).error(2);
        assert!(message.contains("friction.arrow"), "{message}");
    }
    assert!(!campaign.path("out/report.html").exists());
}

#[test]
fn an_exported_figure_is_the_plotted_one() {
    let campaign = finished();
    let plotted = outcome(&campaign, "plot friction out").result();
    assert_eq!(outcome(&campaign, "export out --format svg").result(), plotted);
}

#[test]
fn every_figure_is_drawn_as_svg_and_png() {
    let campaign = finished();
    let list = outcome(&campaign, "plot --list").result();
    let names: Vec<&str> = list.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(names.len(), 21);
    for name in names {
        // No measured profiles, one speed, no adhesion, no heat, no published table, no microscale, no maps, no study.
        let absent = [
            "methods",
            "speed",
            "total",
            "effects",
            "comparison",
            "correction",
            "pressure-map",
            "direction",
            "study",
        ];
        if absent.contains(&name) {
            let message = outcome(&campaign, &format!("plot {name} out")).error(2);
            assert!(message.contains("it needs"), "{message}");
            continue;
        }
        let svg = outcome(&campaign, &format!("plot {name} out")).result();
        assert!(elements(&svg, "svg") >= 1 && elements(&svg, "text") > 4, "{name}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{name}");
        outcome(&campaign, &format!("plot {name} out --to {name}.png")).result();
        let png = fs::read(campaign.path(&format!("{name}.png"))).unwrap();
        assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"), "{name}");
        let side = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
        assert!(side(16) >= 640 && side(20) >= 400, "{name}: {} x {}", side(16), side(20));
    }
    let format = outcome(&campaign, "plot scans out --to scans.gif").error(2);
    assert!(format.contains("figures are .svg or .png files"), "{format}");
    let again = outcome(&campaign, "plot scans out --to scans.png").error(2);
    assert!(again.contains("--force"), "{again}");
    let unknown = outcome(&campaign, "plot fiction out").error(2);
    assert!(
        unknown.contains("there is no figure `fiction`; did you mean `friction`?"),
        "{unknown}"
    );
}

/// A finished run of a small map: two of its windows, slid over in two directions.
fn finished_map() -> Campaign {
    let campaign = Campaign::new();
    let synth = "synth map --out map.x3p --length-mm 4.8 --spacing-um 50 --missing-fraction 0";
    outcome(&campaign, synth).result();
    let recipe = r#"title = "Small map"
[ingest]
scans = ["map.x3p"]
map_lines = "rows"
map_line_step = 32
[ingest.conditioning]
form = "slope"
[ingest.maps]
window_length_mm = [2.4, 4.8]
form = "plane"
[approximate]
waves = [2]
shortest_wavelength_mm = 0.6
[realise]
methods = ["measured", "random-phase"]
realisations = 2
areal_realisations = 2
periodic = "blend"
seed = 1
[bem]
rubber = "rubber.toml"
speeds_mm_s = [10.0]
area_fractions = [0.05, 0.2]
points_per_shortest_wavelength = 16
[areal]
angles_deg = [0.0, 90.0]
field_area_fractions = [0.2]
points_per_shortest_wavelength = 8
"#;
    campaign.write("recipe.toml", recipe);
    outcome(&campaign, RUN).result();
    campaign
}

/// Texts of a figure in their order.
fn texts(svg: &str) -> Vec<String> {
    let after = svg.split("<text").skip(1);
    let text =
        |part: &str| part.split_once('>')?.1.split_once('<').map(|text| text.0.trim().to_owned());
    after.filter_map(text).collect()
}

#[test]
fn maps_have_pictures_of_their_contacts() {
    let campaign = finished_map();
    let svg = outcome(&campaign, "plot pressure-map out").result();
    // Pressure and patches, each with its colour bar.
    assert_eq!(elements(&svg, "image"), 4);
    assert!(svg.len() < 200_000, "{}", svg.len());
    let shown = texts(&svg);
    let has = |start: &str| shown.iter().any(|text| text.starts_with(start));
    for text in [
        "Pressure, measured maps, realisation 1, 10 mm/s",
        "Patches, measured maps, realisation 1, 10 mm/s",
        "contact pressure / MPa",
        "area of the patch / mm²",
        "0.5 mm",
        "the rubber slides, 0° from x",
        "mean pressure 0.",
        "waves from 0.600 mm, rubber tread",
        "the largest has",
    ] {
        assert!(has(text), "{text}: {shown:?}");
    }
    assert!(shown.iter().any(|text| text.contains("contact patch")), "{shown:?}");
    assert_eq!(svg, outcome(&campaign, "plot pressure-map out").result());
    outcome(&campaign, "plot pressure-map out --to map.png").result();

    let svg = outcome(&campaign, "plot direction out").result();
    let shown = texts(&svg);
    // Of 0.05 and 0.2 the former is nearer to 5 %.
    assert!(shown.contains(&"10 mm/s, Ac/A0 = 0.05, rubber tread".to_owned()), "{shown:?}");
    assert!(shown.contains(&"measured maps, mean of 2, 95 %".to_owned()), "{shown:?}");
    assert!(shown.contains(&"maps, random phases, mean of 2, 95 %".to_owned()), "{shown:?}");
}

#[test]
fn a_report_tells_maps_from_profiles() {
    let campaign = finished_map();
    let page = report(&campaign);
    for text in [
        "<section id=\"areal\"",
        "id=\"figure-pressure-map\"",
        "id=\"figure-direction\"",
        "1 height map was read, and 2 of 2 windows kept.",
        "measured maps of 2 windows, waves from 0.6000 mm, 10 mm/s at 0° from x",
        "Areal surfaces, made periodic</caption>",
        "contacts of areal surfaces took",
        "the rubber slides at 0° from x, the rows of the maps",
        "its ratio to that of the measured profiles</caption>",
    ] {
        assert!(page.contains(text), "{text}");
    }
    // Profiles have no direction.
    assert!(!page.contains("measured profiles of 3 windows, waves from 0.6000 mm, 10 mm/s at"));
    let links: Vec<&str> = page.split("href=\"").skip(1).collect();
    assert!(links.iter().all(|link| link.starts_with('#') || link.starts_with("data:")));
    assert!(!page.contains("NaN") && !page.contains("inf<"));
    assert_eq!(page, report(&campaign));
}
