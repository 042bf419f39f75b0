//! What a run came to.

use asperity::artifact::{Digest, RunView};
use asperity::stages::Stage;
use std::collections::BTreeMap;
use std::path::Path;

/// Content digests of all files of all finished stages.
pub fn digests(out: &Path) -> BTreeMap<String, Digest> {
    let view = RunView::of(out);
    let stages = Stage::ALL.iter();
    let manifests = stages.filter_map(|s| view.stage_manifest(s.name()).unwrap());
    manifests
        .flat_map(|m| {
            let name = move |file: &str| format!("{}/{file}", m.stage);
            m.outputs.clone().into_iter().map(move |o| (name(&o.file), o.content_digest))
        })
        .collect()
}
