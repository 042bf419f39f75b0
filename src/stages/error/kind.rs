//! Whether an error of a stage is the input's, a failure or the interrupt.

use super::StageError;
use crate::error_kind::{ErrorKind, HasKind};

impl HasKind for StageError {
    fn kind(&self) -> ErrorKind {
        match self {
            // A table of an earlier stage that is not as it was written.
            Self::Metadata { .. } => ErrorKind::Input,
            Self::Artifact(source) => source.kind(),
            Self::Shear(source) => source.kind(),
            Self::Scan(source) => source.kind(),
            Self::File(source) => source.kind(),
            Self::Conditioning(source) => source.kind(),
            Self::FaultPicture(source) => source.kind(),
            Self::Parameter(source) => source.kind(),
            Self::Correlation(source) => source.kind(),
            Self::Spectrum(source) => source.kind(),
            Self::Ladder(source) => source.kind(),
            Self::SineFit { source, .. } => source.kind(),
            Self::Periodic(source) => source.kind(),
            Self::MapConditioning(source) => source.kind(),
            Self::Areal(source) => source.kind(),
            Self::Gap(source) => source.kind(),
            Self::PeriodicMap(source) => source.kind(),
            Self::Rubber(source) => source.kind(),
            Self::Contact { source, .. } | Self::ArealContact { source, .. } => source.kind(),
            Self::Microscale { source, .. }
            | Self::FiniteDeformation { source, .. }
            | Self::Solve { source, .. } => source.kind(),
            Self::MapLines { .. }
            | Self::NoTextFormat { .. }
            | Self::NoMapLeft { .. }
            | Self::MapWindow { .. }
            | Self::ArealSurface { .. }
            | Self::FlatWindow { .. }
            | Self::IsotropicPeriod { .. }
            | Self::NoIsotropicSpectrum
            | Self::ArealMemory { .. }
            | Self::NoScans { .. }
            | Self::ScanIo { .. }
            | Self::ScanChanged { .. }
            | Self::ReservedName { .. }
            | Self::SameName { .. }
            | Self::UnequalScans { .. }
            | Self::NoWaves { .. }
            | Self::RubberAtFiniteDeformation { .. }
            | Self::NoRelaxationTimes { .. }
            | Self::NoTemperatureLaw { .. }
            | Self::NoStrainLaw { .. }
            | Self::NoMacroscale { .. }
            | Self::NoRelaxation { .. }
            | Self::Published { .. } => ErrorKind::Input,
            Self::NoMicroscale { .. }
            | Self::NoMethods { .. }
            | Self::NoFeedback { .. }
            | Self::TooFewRealisations { .. } => ErrorKind::Failure,
            Self::Interrupted => ErrorKind::Interrupted,
        }
    }
}
