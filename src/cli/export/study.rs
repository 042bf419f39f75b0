//! Export of the study of one sine wave.

use super::{Export, Format};
use crate::cli::CliError;
use asperity::artifact::{ExportTable, RunView};
use asperity::report::{Study, study_figure};

const STAGE: &str = "sinusoid";

impl Export {
    pub(super) fn study(&self, view: &RunView) -> Result<(), CliError> {
        let chosen = self.model.is_some()
            || self.method.is_some()
            || self.waves.is_some()
            || self.speed.is_some();
        if self.comparison || chosen {
            return Err(CliError::input(
                "the study of one sine has no tables to choose from: leave --comparison, --model, \
                 --waves and --speed out",
            ));
        }
        match self.format {
            Format::Markdown => self.text(&read(view)?.markdown()),
            Format::Svg => self.text(&study_figure(&read(view)?).svg()?),
            Format::Csv => self.study_csv(view),
            Format::Latex | Format::Parquet | Format::Xlsx => {
                Err(CliError::input("the study of one sine is exported as markdown, csv or svg"))
            }
        }
    }

    /// One CSV file for each table, named like it.
    fn study_csv(&self, view: &RunView) -> Result<(), CliError> {
        let Some(folder) = &self.to else {
            return Err(CliError::input("there are several tables: give a folder with --to"));
        };
        std::fs::create_dir_all(folder).map_err(|error| CliError::no_folder(folder, &error))?;
        let manifest = view.stage_manifest(STAGE)?;
        for output in manifest.into_iter().flat_map(|manifest| manifest.outputs) {
            let table = ExportTable::read(&view.file(STAGE, &output.file))?;
            let path = folder.join(&output.file).with_extension("csv");
            self.bytes(&path, table.csv())?;
        }
        Ok(())
    }
}

fn read(view: &RunView) -> Result<Study, CliError> {
    Study::read(view).map_err(CliError::input)
}
