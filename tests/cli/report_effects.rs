//! Total friction and friction with heat and softening, in the report, in figures and in workbooks.

use super::Outcome;
use crate::common::Campaign;
use asperity::artifact::RunView;
use asperity::scans::description::{Column, DecimalMark};
use asperity::scans::spreadsheet::Book;
use asperity::stages::tables::{EFFECTS, TOTAL};

const RUN: &str = "run recipe.toml --out out --quiet";
const LAWS: &str = "\n[temperature]\nreference_c = 20.0\nwlf = { c1 = 8.86, c2_k = 101.6 }\n\n[payne]\n\
    strain_kind = \"elongation\"\n[[payne.kraus]]\ncritical_strain = 0.01\nexponent = 0.6\nstorage_limit = 0.4\n\
    loss_limit = 0.4\nloss_peak = 0.2\nhighest_strain = 0.5\n";
const FEEDBACK: &str = "\n[feedback]\nstrain = true\n\n[feedback.heat]\nconductivity_w_mk = 0.3\ndensity_kg_m3 = 1150\n\
    heat_capacity_j_kgk = 1500\nsliding_time_s = 0.02\n";
const ADHESION: &str = "\n[adhesion]\nlaw = \"gaussian\"\nshear_mpa = 1.5\nspeed_mm_s = 6.0\nwidth = 0.1\n\
    shortest_wavelength_mm = 0.5\n";

fn outcome(campaign: &Campaign, arguments: &str) -> Outcome {
    Outcome::of(&mut campaign.command(arguments))
}

/// A finished run at two speeds and one pressure, of measured profiles, with sections of its own.
fn finished(sections: &str) -> Campaign {
    let campaign = Campaign::new();
    let rubber = campaign.read("rubber.toml");
    campaign.write("rubber.toml", &(rubber + LAWS));
    let draws = "waves = [3]\nrealisations = 2\nseed = 1";
    campaign.edit("recipe.toml", draws, "methods = [\"measured\"]");
    campaign.edit("recipe.toml", "area_fractions = [0.02, 0.05, 0.1]", "area_fractions = []");
    let pressure = "pressures_mpa = [0.05]\ntemperature_c = 25.0";
    campaign.edit("recipe.toml", "tolerance = 5e-3", pressure);
    campaign.edit("recipe.toml", "[10.0]", "[10.0, 1000.0]");
    campaign.write("recipe.toml", &(campaign.read("recipe.toml") + sections));
    outcome(&campaign, RUN).result();
    campaign
}

/// The part of a report between the heading of a section and the next section.
fn section(page: &str, id: &str) -> Option<String> {
    let start = page.find(&format!("<section id=\"{id}\""))?;
    let end = start + page[start..].find("</section>")?;
    Some(page[start..end].to_owned())
}

fn report(campaign: &Campaign) -> String {
    outcome(campaign, "report out --to report.html --force --quiet").result();
    campaign.read("report.html")
}

/// Texts of the cells of the body of a table, row by row; a section here has one table.
fn cells(section: &str) -> Vec<Vec<String>> {
    let (_, body) = section.split_once("<tbody>").unwrap();
    let (body, after) = body.split_once("</tbody>").unwrap();
    assert!(!after.contains("<tbody>"));
    let text = |cell: &str| cell.split_once('<').unwrap().0.to_owned();
    let row = |row: &str| {
        let cells = row.split('>').skip(1).step_by(2).filter(|cell| !cell.is_empty());
        cells.map(text).collect::<Vec<_>>()
    };
    body.split("<tr>").skip(1).map(row).collect()
}

/// A number as the report writes it, with four digits.
fn shown(value: f64) -> String {
    if value < 1e-3 {
        return String::new();
    }
    let decimals = 3 - value.log10().floor() as i32;
    format!("{value:.*}", decimals.max(0) as usize)
}

#[test]
fn a_report_has_total_friction_and_that_under_every_effect() {
    let campaign = finished(&[FEEDBACK, ADHESION].concat());
    let page = report(&campaign);
    let order = ["friction", "total", "effects", "correction"];
    let places = order.map(|id| page.find(&format!("<section id=\"{id}\"")).unwrap());
    assert!(places.is_sorted(), "{places:?}");
    assert!(page.contains("hysteretic and total friction of rubber"));
    let view = RunView::of(campaign.path("out"));

    let part = section(&page, "total").unwrap();
    assert!(part.contains("<h2>Total friction</h2>") && part.contains("25 °C"), "{part}");
    let totals = view.rows(TOTAL).unwrap();
    let table = cells(&part);
    assert_eq!((totals.len(), table.len()), (2, 2));
    for (row, cells) in totals.iter().zip(&table) {
        assert_eq!(cells[..3], ["bem".into(), row.kind.to_string(), row.speed_mm_s.to_string()]);
        let numbers = [row.shear_mpa, row.hysteretic, row.adhesive, row.total].map(shown);
        assert_eq!(cells[5..9], numbers, "{cells:?}");
    }

    let part = section(&page, "effects").unwrap();
    assert!(part.contains("<h2>Heat and softening</h2>"), "{part}");
    let effects = view.rows(EFFECTS).unwrap();
    let table = cells(&part);
    assert_eq!((effects.len(), table.len()), (8, 8));
    for (row, cells) in effects.iter().zip(&table) {
        assert_eq!(cells[1..3], [row.effect.to_string(), row.speed_mm_s.to_string()]);
        assert_eq!(cells[4], shown(row.contact_area_fraction), "{cells:?}");
        assert_eq!(cells[5], shown(row.hysteretic), "{cells:?}");
        let sums = [row.adhesive, row.total].map(|sum| shown(sum.unwrap()));
        assert_eq!(cells[7..9], sums, "{cells:?}");
        assert_eq!(cells[10] == "–", row.contact_rise_k.is_none(), "{cells:?}");
    }
    assert_eq!(part.matches("<svg").count(), 2);
    assert!(!page.contains("NaN") && !page.contains("inf<"));
    assert_eq!(page, report(&campaign));
}

#[test]
fn runs_without_adhesion_or_feedback_have_no_such_sections() {
    let campaign = finished("");
    let page = report(&campaign);
    assert!(section(&page, "friction").is_some());
    assert!(section(&page, "total").is_none() && section(&page, "effects").is_none());
    assert!(!page.contains("Total friction") && !page.contains("Heat and softening"));
    for (figure, key) in [("total", "[adhesion]"), ("effects", "[feedback]")] {
        let message = outcome(&campaign, &format!("plot {figure} out")).error(2);
        assert!(message.contains(&format!("section {key}")), "{message}");
    }
    // Heat without adhesion: no totals anywhere.
    campaign.write("recipe.toml", &(campaign.read("recipe.toml") + FEEDBACK));
    outcome(&campaign, RUN).result();
    let page = report(&campaign);
    assert!(section(&page, "total").is_none());
    let part = section(&page, "effects").unwrap();
    assert!(!part.contains("total"), "{part}");
    assert_eq!((part.matches("<svg").count(), cells(&part)[0].len()), (1, 9));
}

#[test]
fn figures_are_over_that_of_which_there_is_more() {
    let campaign = finished(&[FEEDBACK, ADHESION].concat());
    let texts = |figure: &str, expected: &[&str]| {
        let svg = outcome(&campaign, &format!("plot {figure} out")).result();
        for text in expected {
            assert!(svg.contains(text), "{figure}: {text}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{figure}");
    };
    let speed = ["0.05 MPa, ", "sliding speed"];
    texts("total", &[&speed[..], &["hysteretic, 95 %", "adhesive", "total, 95 %"]].concat());
    let effects =
        ["cold, 95 %", "soft, 95 %", "hot, all errors", "soft-hot, all errors", "total friction"];
    texts("effects", &[&speed[..], &effects].concat());
    // One speed and one pressure: points side by side, with error bars.
    campaign.edit("recipe.toml", "[10.0, 1000.0]", "[1000.0]");
    outcome(&campaign, RUN).result();
    for figure in ["total", "effects"] {
        texts(figure, &["1000 mm/s, ", "mean pressure p / MPa", "<circle"]);
        outcome(&campaign, &format!("plot {figure} out --to {figure}.png")).result();
    }
}

/// Names of the sheets of an exported workbook.
fn sheets(campaign: &Campaign, options: &str) -> Vec<String> {
    let export = format!("export out --format xlsx --to friction.xlsx --force {options}");
    outcome(campaign, &export).result();
    let bytes = std::fs::read(campaign.path("friction.xlsx")).unwrap();
    Book::open(&bytes).unwrap().sheets()
}

/// The lines of a sheet below its caption, as cells.
fn lines(campaign: &Campaign, sheet: &str) -> Vec<Vec<String>> {
    let bytes = std::fs::read(campaign.path("friction.xlsx")).unwrap();
    let name = Column::Name(sheet.into());
    let text = Book::open(&bytes).unwrap().text(Some(&name), DecimalMark::Point).unwrap();
    let cells = |line: &str| line.split('\t').map(str::to_owned).collect();
    text.lines().skip(2).map(cells).collect()
}

#[test]
fn a_workbook_has_a_sheet_for_each_of_both_with_all_digits() {
    let campaign = finished(&[FEEDBACK, ADHESION].concat());
    let names = sheets(&campaign, "");
    assert_eq!(
        (names.len(), &names[2..]),
        (4, &["total friction", "heat and softening"].map(str::to_owned)[..])
    );
    let view = RunView::of(campaign.path("out"));
    let (totals, effects) = (view.rows(TOTAL).unwrap(), view.rows(EFFECTS).unwrap());
    let number = |lines: &[Vec<String>], row: usize, name: &str| -> f64 {
        let column = lines[0].iter().position(|own| own == name).unwrap();
        lines[row + 1][column].parse().unwrap()
    };
    let sheet = lines(&campaign, "total friction");
    assert_eq!(sheet.len(), 1 + totals.len());
    for (k, row) in totals.iter().enumerate() {
        let found = ["hysteretic", "adhesive", "total"].map(|name| number(&sheet, k, name));
        assert_eq!(found, [row.hysteretic, row.adhesive, row.total]);
    }
    let sheet = lines(&campaign, "heat and softening");
    assert_eq!(sheet.len(), 1 + effects.len());
    for (k, row) in effects.iter().enumerate() {
        let found = ["hysteretic", "total", "realisation 1"].map(|name| number(&sheet, k, name));
        assert_eq!(found, [row.hysteretic, row.total.unwrap(), row.realisations[0]]);
    }
    // What is left out of the friction tables is left out of these.
    assert_eq!(sheets(&campaign, "--speed 10").len(), 3);
    assert_eq!(lines(&campaign, "heat and softening").len(), 1 + 4);
}
