//! The report of a run: one HTML document that needs nothing else.
//!
//! | module | what it holds |
//! |---|---|
//! | `areal` | surfaces that are rough in both directions: roughness, direction, contact patches |
//! | `contact` | sections on the correction, the fields and the rubber |
//! | `effects` | sections on total friction, and on the heat and softening of the contact |
//! | `friction` | sections on friction, its tables and its error |
//! | `page` | parts that all sections are made of |
//! | `provenance` | where the results come from and how to compute them again |
//! | `roughness` | sections on correlation, spectrum and waves |
//! | `scans` | sections on the scans |
//! | `study` | the study of one sine wave |

mod areal;
mod contact;
mod effects;
mod friction;
mod page;
mod provenance;
mod roughness;
mod scans;
mod study;

use super::ReportError;
use super::figures::Kind;
use crate::artifact::{RunView, TOOL_VERSION};
use crate::stages;
use crate::stages::Stage;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use std::collections::BTreeMap;

pub(crate) use page::number;

const STYLE: &str = include_str!("style.css");

/// What is known of a run beyond its results.
#[derive(Debug, Clone, Default)]
pub struct Origin {
    /// Command that brought the run folder up to date.
    pub command: Option<String>,
    /// Text of the recipe at that time.
    pub recipe: Option<String>,
    /// Version of the tool that ran last.
    pub tool_version: Option<String>,
    /// Number of threads of the last run.
    pub threads: Option<usize>,
    /// Stages whose results are not what the recipe asks for any more, and why.
    pub doubts: BTreeMap<Stage, String>,
}

/// A part of the document.
struct Section {
    id: &'static str,
    title: &'static str,
    body: Markup,
}

/// The document of a run.
///
/// # Errors
/// [`ReportError`] if a result is damaged or of another version, if a figure cannot be drawn, or if
/// the folder has no results.
pub fn document(run: &RunView, origin: &Origin) -> Result<String, ReportError> {
    let mut any = false;
    for stage in Stage::ALL {
        any |= run.stage_manifest(stage.name())?.is_some();
    }
    if !any {
        return Err(ReportError::Empty { folder: run.path().display().to_string() });
    }
    let report = Report { run, origin };
    let sections = report.sections()?;
    let title = report.title();
    let shown = if report.has_totals()? { "hysteretic and total" } else { "hysteretic" };
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content=(format!("asperity {TOOL_VERSION}"));
                title { (title) }
                // No picture of its own; without this a browser asks for one.
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body {
                header {
                    h1 { (title) }
                    p { "Report of asperity " (TOOL_VERSION) ": " (shown) " friction of rubber on a rough \
                        surface. Every number comes from the results in the run folder; ± and bands \
                        are 95 % confidence intervals unless said otherwise." }
                    (report.doubts())
                }
                nav aria-label="Contents" {
                    ul { @for section in &sections {
                        li { a href={ "#" (section.id) } { (section.title) } }
                    } }
                }
                main { @for section in &sections {
                    section id=(section.id) { h2 { (section.title) } (section.body) }
                } }
            }
        }
    };
    Ok(page.into_string())
}

/// A run and where its results come from.
struct Report<'a> {
    run: &'a RunView,
    origin: &'a Origin,
}

impl Report<'_> {
    fn sections(&self) -> Result<Vec<Section>, ReportError> {
        let mut sections = vec![];
        let mut add = |id, title, body| sections.push(Section { id, title, body });
        if self.has(stages::sinusoid::STAGE)? {
            add("study", "One sine under three models", self.study()?);
        } else {
            add("input", "Scans: what came in and what was cleaned", self.input()?);
            add("heights", "Heights and their distribution", self.heights()?);
            add(
                "correlation",
                "Height-difference correlation and the fit of sines",
                self.correlation()?,
            );
            add("spectrum", "Power spectral density", self.spectrum()?);
            add("waves", "Waves, slopes and the model of each", self.waves()?);
            add("friction", "Friction over contact area", self.friction()?);
            if self.has_totals()? {
                add("total", "Total friction", self.total()?);
            }
            if self.has_effects()? {
                add("effects", "Heat and softening", self.effects()?);
            }
            add("correction", "Correction over pressure", self.correction()?);
            add("fields", "Pressure along profiles and deformed profiles", self.fields()?);
            if self.has_areal_surfaces()? {
                add(
                    "areal",
                    "Areal surfaces: roughness, direction and contact patches",
                    self.areal()?,
                );
            }
            add("rubber", "Rubber and the frequencies that the surface excites", self.rubber()?);
            add("tables", "Tables", self.tables()?);
            add("accuracy", "Speed against error", self.accuracy()?);
        }
        add("provenance", "Provenance and the recipe", self.provenance()?);
        Ok(sections)
    }

    fn has(&self, stage: Stage) -> Result<bool, ReportError> {
        Ok(self.run.stage_manifest(stage.name())?.is_some())
    }

    /// The title of the recipe, or the name of the folder.
    fn title(&self) -> String {
        let recipe = self.origin.recipe.as_deref();
        let title = recipe.and_then(|text| text.parse::<toml::Table>().ok());
        let title = title.and_then(|table| table.get("title")?.as_str().map(str::to_owned));
        title.unwrap_or_else(|| {
            let name = self.run.path().file_name().unwrap_or(self.run.path().as_os_str());
            format!("Run {}", name.to_string_lossy())
        })
    }

    fn doubts(&self) -> Markup {
        html! { @for doubt in self.origin.doubts.values() {
            p.warning role="note" { strong { "Not up to date: " } (doubt) }
        } }
    }

    /// Why results of these stages are not up to date, for the section that shows them.
    fn doubt(&self, stages: &[Stage]) -> Markup {
        html! { @for doubt in stages.iter().filter_map(|stage| self.origin.doubts.get(stage)) {
            p.warning role="note" { strong { "Not up to date: " } (doubt) }
        } }
    }

    /// What a user should know about results of a stage.
    fn warnings(&self, stages: &[Stage]) -> Result<Markup, ReportError> {
        let mut warnings = vec![];
        for stage in stages {
            let manifest = self.run.stage_manifest(stage.name())?;
            warnings.extend(manifest.into_iter().flat_map(|manifest| manifest.warnings));
        }
        Ok(html! {
            (self.doubt(stages))
            @for warning in warnings { p.warning role="note" { strong { "Warning: " } (warning) } }
        })
    }

    /// A figure by its name, or a sentence on why it is not there.
    fn figure(&self, name: &'static str) -> Result<Markup, ReportError> {
        let Some(kind) = Kind::named(name) else { return Ok(html! {}) };
        let Some(figure) = kind.figure(self.run)? else {
            return Ok(page::absent(&format!(
                "No figure of {}: it needs {}.",
                kind.shows, kind.requires
            )));
        };
        let elements = figure
            .elements(name)
            .map_err(|source| ReportError::Figure { name: kind.name, source })?;
        Ok(html! { figure id={ "figure-" (name) } {
            div.panels { @for element in elements {
                div.panel tabindex="0" role="group" aria-label=(kind.shows) { (PreEscaped(element)) }
            } }
            figcaption { (figure.caption) }
        } })
    }
}
