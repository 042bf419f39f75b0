//! Provenance of a result: what went in, what came out, and the key that decides whether a result
//! is still that of the recipe.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::{ArtifactError, Digest, TOOL_VERSION};

/// Schema name and version of one kind of output.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SchemaVersion {
    /// Schema name, such as `asperity.bem.solves`.
    pub schema: String,
    /// Schema version.
    pub version: u32,
}

/// One thing a stage reads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Input {
    /// Name within the stage, such as `approximate/waves.arrow`.
    pub name: String,
    /// Content digest.
    pub digest: Digest,
    /// Where a file from outside came from; no part of the key.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub origin: Option<String>,
}

/// One file of a result.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// File name in the folder of the stage.
    pub file: String,
    /// Schema name.
    pub schema: String,
    /// Schema version.
    pub schema_version: u32,
    /// Digest of the bytes, to find damage.
    pub bytes_digest: Digest,
    /// Digest of the content without volatile columns, tool version and descriptions; what the
    /// next stage depends on.
    pub content_digest: Digest,
    /// Size in bytes.
    pub size: u64,
}

/// All that determines the result of a stage, known before it runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// Stage name, such as `bem`.
    pub stage: String,
    /// Revision of the stage, raised when the same parameters give other numbers.
    pub stage_revision: u32,
    /// Schemas of the outputs, in any order.
    pub output_schemas: Vec<SchemaVersion>,
    /// Every parameter with its resolved value.
    pub parameters: Value,
    /// What the stage reads, in any order.
    pub inputs: Vec<Input>,
}

impl Identity {
    /// The key of the result: digest of stage name, revision, output schemas with versions,
    /// parameters, and names and content digests of the inputs. Time, threads, paths and the
    /// version of the tool are no part of it.
    pub fn key(&self) -> Digest {
        let mut schemas = self.output_schemas.clone();
        schemas.sort();
        schemas.dedup();
        let mut inputs: Vec<_> =
            self.inputs.iter().map(|input| (&input.name, input.digest.to_string())).collect();
        inputs.sort();
        let schemas: Vec<_> = schemas.iter().map(|s| json!([s.schema, s.version])).collect();
        Digest::of_value(&json!({
            "stage": self.stage,
            "revision": self.stage_revision,
            "schemas": schemas,
            "parameters": self.parameters,
            "inputs": inputs,
        }))
    }
}

/// The manifest of a result, `manifest.json` beside its files. It has no time stamp, so equal runs
/// differ in `seconds` alone.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Always [`Manifest::SCHEMA`].
    pub schema: String,
    /// Version of the manifest itself, [`Manifest::VERSION`].
    pub version: u32,
    /// Version of the tool that ran the stage.
    pub tool_version: String,
    /// Stage name.
    pub stage: String,
    /// Revision of the stage.
    pub stage_revision: u32,
    /// Key of the result, see [`Identity::key`].
    pub key: Digest,
    /// Every parameter with its resolved value.
    pub parameters: Value,
    /// What the stage read.
    pub inputs: Vec<Input>,
    /// Files of the result.
    pub outputs: Vec<Output>,
    /// What a user should know about the result.
    pub warnings: Vec<String>,
    /// Wall time of the stage in seconds.
    pub seconds: f64,
    /// Digest of all other fields, to find damage of the manifest itself.
    pub digest: Digest,
}

impl Manifest {
    /// Schema name of a manifest.
    pub const SCHEMA: &'static str = "asperity.manifest";
    /// Version of the manifest.
    pub const VERSION: u32 = 2;
    /// File name of a manifest.
    pub const FILE: &'static str = "manifest.json";

    /// Manifest of a result that was computed for `identity`.
    ///
    /// # Errors
    /// [`ArtifactError::NotRepresentable`] if it has no JSON form.
    pub fn new(
        identity: &Identity,
        outputs: Vec<Output>,
        warnings: Vec<String>,
        seconds: f64,
    ) -> Result<Self, ArtifactError> {
        let mut manifest = Self {
            schema: Self::SCHEMA.to_owned(),
            version: Self::VERSION,
            tool_version: TOOL_VERSION.to_owned(),
            stage: identity.stage.clone(),
            stage_revision: identity.stage_revision,
            key: identity.key(),
            parameters: identity.parameters.clone(),
            inputs: identity.inputs.clone(),
            outputs,
            warnings,
            seconds,
            digest: Digest::of_bytes(&[]),
        };
        manifest.digest = Digest::seal_of(&manifest)?;
        Ok(manifest)
    }

    /// The output of that file name.
    pub fn output(&self, file: &str) -> Option<&Output> {
        self.outputs.iter().find(|output| output.file == file)
    }

    /// The output as input of another stage, named `stage/file`.
    pub fn input(&self, file: &str) -> Option<Input> {
        let digest = self.output(file)?.content_digest;
        Some(Input { name: format!("{}/{file}", self.stage), digest, origin: None })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Identity {
        let input = |name: &str| Input {
            name: name.into(),
            digest: Digest::of_bytes(name.as_bytes()),
            origin: None,
        };
        Identity {
            stage: "bem".into(),
            stage_revision: 3,
            output_schemas: vec![
                SchemaVersion { schema: "asperity.bem.solves".into(), version: 1 },
                SchemaVersion { schema: "asperity.bem.pressures".into(), version: 1 },
            ],
            parameters: json!({ "speeds_mm_s": [0.1, 10.0], "grid": { "points": 1024 } }),
            inputs: vec![input("realise/surfaces.h5"), input("rubber")],
        }
    }

    #[test]
    fn every_ingredient_changes_the_key() {
        let changes: [fn(&mut Identity); 9] = [
            |i| i.stage = "fem".into(),
            |i| i.stage_revision = 4,
            |i| i.output_schemas[0].version = 2,
            |i| i.output_schemas[1].schema.push('x'),
            |i| i.parameters["speeds_mm_s"][0] = json!(f64::from_bits(0.1_f64.to_bits() + 1)),
            |i| i.parameters["grid"]["levels"] = json!(null),
            |i| i.inputs[0].name.push('x'),
            |i| i.inputs[0].digest = Digest::of_bytes(b"other"),
            |i| drop(i.inputs.pop()),
        ];
        let mut keys = vec![identity().key()];
        for change in changes {
            let mut changed = identity();
            change(&mut changed);
            keys.push(changed.key());
        }
        let distinct: std::collections::BTreeSet<_> = keys.iter().collect();
        assert_eq!(distinct.len(), keys.len());
    }

    #[test]
    fn order_and_origin_do_not_change_the_key() {
        let mut changed = identity();
        changed.inputs.reverse();
        changed.inputs[0].origin = Some("elsewhere/rubber.toml".into());
        changed.output_schemas.reverse();
        assert_eq!(changed.key(), identity().key());
    }

    #[test]
    fn a_manifest_reads_back_and_names_its_outputs() {
        let content_digest = Digest::of_bytes(b"content");
        let output = Output {
            file: "solves.arrow".into(),
            schema: "asperity.bem.solves".into(),
            schema_version: 1,
            bytes_digest: Digest::of_bytes(b"bytes"),
            content_digest,
            size: 12,
        };
        let manifest =
            Manifest::new(&identity(), vec![output], vec!["µ > 2".into()], 0.1 + 0.2).unwrap();
        let text = serde_json::to_string_pretty(&manifest).unwrap();
        assert_eq!(serde_json::from_str::<Manifest>(&text).unwrap(), manifest);
        assert_eq!(Digest::seal_of(&manifest).unwrap(), manifest.digest);
        let input = manifest.input("solves.arrow").unwrap();
        assert_eq!((input.name.as_str(), input.digest), ("bem/solves.arrow", content_digest));
        assert_eq!(manifest.input("other.arrow"), None);
    }
}
