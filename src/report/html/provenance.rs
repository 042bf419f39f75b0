//! Where the results come from and how to compute them again.

use super::Report;
use super::page::{absent, table};
use crate::artifact::Manifest;
use crate::report::ReportError;
use crate::stages::Stage;
use maud::{Markup, html};

impl Report<'_> {
    pub(super) fn provenance(&self) -> Result<Markup, ReportError> {
        let mut manifests = vec![];
        for stage in Stage::ALL {
            manifests.extend(self.run.stage_manifest(stage.name())?.map(|found| (stage, found)));
        }
        let origin = self.origin;
        Ok(html! {
            (stage_table(&manifests, self))
            (input_table(&manifests))
            (output_table(&manifests))
            h3 { "How to compute it again" }
            @match &origin.command {
                Some(command) => { p { "The command of the last run" (threads(origin.threads, origin.tool_version.as_deref())) ":" }
                    pre tabindex="0" { (command) } }
                None => (absent("The run folder does not say by which command it was made.")),
            }
            @match &origin.recipe {
                Some(recipe) => { p { "The recipe as it was then:" } pre tabindex="0" { (recipe) } }
                None => (absent("The run folder does not keep the text of its recipe: `asperity run` of \
                    this version brings it up to date. All parameters follow.")),
            }
            h3 { "Parameters of each stage, as resolved" }
            @for (stage, manifest) in &manifests {
                details { summary { code { (stage.name()) } }
                    pre tabindex="0" { (serde_json::to_string_pretty(&manifest.parameters).unwrap_or_default()) } }
            }
        })
    }
}

fn threads(threads: Option<usize>, version: Option<&str>) -> String {
    let threads = match threads {
        Some(1) => " on 1 thread".into(),
        Some(threads) => format!(" on {threads} threads"),
        None => String::new(),
    };
    let version = version.map_or(String::new(), |version| format!(", asperity {version}"));
    threads + &version
}

fn stage_table(manifests: &[(Stage, Manifest)], report: &Report) -> Markup {
    let state = |stage: &Stage| match report.origin.doubts.get(stage) {
        Some(_) => "not up to date",
        None => "",
    };
    table(
        "Stages",
        &[
            "stage",
            "asperity",
            "key of the result",
            "state",
            "revision",
            "wall time / s",
            "warnings",
        ],
        4,
        manifests.iter().map(|(stage, manifest)| {
            vec![
                stage.name().to_owned(),
                manifest.tool_version.clone(),
                format!("{:#}", manifest.key),
                state(stage).to_owned(),
                manifest.stage_revision.to_string(),
                format!("{:.2}", manifest.seconds),
                manifest.warnings.len().to_string(),
            ]
        }),
    )
}

fn input_table(manifests: &[(Stage, Manifest)]) -> Markup {
    let inputs = manifests
        .iter()
        .flat_map(|(stage, manifest)| manifest.inputs.iter().map(move |input| (stage, input)));
    table(
        "Inputs and their BLAKE3 digests",
        &["input", "read by", "from", "digest"],
        4,
        inputs.map(|(stage, input)| {
            vec![
                input.name.clone(),
                stage.name().to_owned(),
                input.origin.clone().unwrap_or_else(|| "this run".into()),
                input.digest.to_string(),
            ]
        }),
    )
}

fn output_table(manifests: &[(Stage, Manifest)]) -> Markup {
    let outputs = manifests
        .iter()
        .flat_map(|(stage, manifest)| manifest.outputs.iter().map(move |output| (stage, output)));
    table(
        "Results and the digests of their content",
        &["result", "schema", "digest", "bytes"],
        3,
        outputs.map(|(stage, output)| {
            vec![
                format!("{stage}/{}", output.file),
                format!("{} {}", output.schema, output.schema_version),
                output.content_digest.to_string(),
                output.size.to_string(),
            ]
        }),
    )
}
