//! Means of a spectrum over bins of equal width in the logarithm of the wavenumber.

use super::{PowerSpectrum, Route, SpectrumError};
use statrs::function::gamma::digamma;

/// Mean density over one bin of wavenumbers, of one scan or of several.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumBin {
    /// Geometric mean in rad/m of the wavenumbers in the bin.
    pub wavenumber: f64,
    /// Arithmetic mean in m³ of the densities in the bin; where the spectrum falls like `q^-n`
    /// it exceeds the density at `wavenumber`, at 20 bins a decade and n = 3 by less than 1 %.
    pub density: f64,
    /// Standard error of `density` in m³. Of several scans, that of the mean of their bins, from
    /// their spread; of one scan, what a Gaussian surface has: `density sqrt(2 / ν)`, with the
    /// degrees of freedom ν of the bin.
    pub standard_error: f64,
    /// Geometric mean in m³ of the densities in the bin over `geometric_bias`: where the
    /// spectrum is a power law it is that at `wavenumber`. `None` where a density is not positive,
    /// which the Blackman-Tukey route allows.
    pub geometric_density: Option<f64>,
    /// The geometric mean of the densities of a Gaussian surface over their arithmetic mean: a
    /// density with ν degrees of freedom has `exp(ψ(ν/2)) / (ν/2)`, a periodogram
    /// `exp(-0.5772) = 0.5615`.
    pub geometric_bias: f64,
    /// Number of wavenumbers in the bin.
    pub count: usize,
}

impl PowerSpectrum {
    /// Means over bins of equal width in `log q`, `per_decade` a decade, with edges at
    /// `10^(j / per_decade)` rad/m whatever the scan; `q = 0` and empty bins are left out.
    pub fn log_binned(&self, per_decade: usize) -> Vec<SpectrumBin> {
        self.members(per_decade).map(|bin| bin_mean(std::slice::from_ref(self), bin)).collect()
    }

    /// The same over several scans as well: the mean is that of their average, the standard error
    /// that from the spread of their bins.
    ///
    /// # Errors
    /// No spectra, or different wavenumbers.
    pub fn log_binned_over(
        spectra: &[Self],
        per_decade: usize,
    ) -> Result<Vec<SpectrumBin>, SpectrumError> {
        let first = Self::check_equal_grids(spectra)?;
        Ok(first.members(per_decade).map(|bin| bin_mean(spectra, bin)).collect())
    }

    /// The bins as ranges of entries.
    fn members(&self, per_decade: usize) -> impl Iterator<Item = std::ops::Range<usize>> {
        let bin = move |k: usize| (self.wavenumber(k).log10() * per_decade as f64).floor();
        let mut start = 1;
        std::iter::from_fn(move || {
            let (first, length) = (start, self.density.len());
            (first < length).then(|| {
                let index = bin(first);
                let edge = 10_f64.powf((index + 1.0) / per_decade as f64);
                // The edge is rounded: entries next to it are assigned by their own logarithm.
                start = ((edge / self.wavenumber_step) as usize).clamp(first + 1, length);
                while start > first + 1 && bin(start - 1) != index {
                    start -= 1;
                }
                while start < length && bin(start) == index {
                    start += 1;
                }
                first..start
            })
        })
    }

    /// Degrees of freedom of one density: those of the scans behind it add up. The Nyquist
    /// wavenumber, which has half of them, is one of many in its bin.
    fn degrees_of_freedom(&self) -> f64 {
        let points = 2.0 * (self.density.len() as f64 - 1.0);
        self.routes.iter().map(|route| route.degrees_of_freedom(points)).sum()
    }

    /// Degrees of freedom of the mean over `count` neighbouring densities.
    fn bin_degrees_of_freedom(&self, count: usize) -> f64 {
        let (points, count) = (2.0 * (self.density.len() as f64 - 1.0), count as f64);
        let of_route = |route: &Route| match route {
            Route::Periodogram(window) => (2.0 * count / window.variance_inflation()).max(2.0),
            // Neighbours say the same until the bin is wider than the lag window smooths.
            Route::BlackmanTukey { .. } => (2.0 * count).max(route.degrees_of_freedom(points)),
        };
        self.routes.iter().map(of_route).sum()
    }
}

impl Route {
    /// Degrees of freedom of one density from a scan of `points` points: 2 of a periodogram,
    /// `3.71 N / M` with Parzen's lag window (Priestley, Spectral Analysis and Time Series, 1981,
    /// table 6.2).
    fn degrees_of_freedom(&self, points: f64) -> f64 {
        match self {
            Self::Periodogram(_) => 2.0,
            Self::BlackmanTukey { maximum_lag } => 3.71 * points / *maximum_lag as f64,
        }
    }
}

/// Expectation of `ln(χ² / ν)` with ν degrees of freedom.
fn log_bias(degrees_of_freedom: f64) -> f64 {
    let half = degrees_of_freedom / 2.0;
    digamma(half) - half.ln()
}

/// `ln` of the mean of a bin, freed of the bias that the logarithm of a few densities has.
pub(super) fn unbiased_log(spectra: &[PowerSpectrum], bin: &SpectrumBin) -> f64 {
    let degrees: f64 = spectra.iter().map(|s| s.bin_degrees_of_freedom(bin.count)).sum();
    bin.density.ln() - log_bias(degrees)
}

fn bin_mean(spectra: &[PowerSpectrum], members: std::ops::Range<usize>) -> SpectrumBin {
    let (count, scans) = (members.len(), spectra.len() as f64);
    let of_scan = |s: &PowerSpectrum| s.density[members.clone()].iter().sum::<f64>() / count as f64;
    let means: Vec<f64> = spectra.iter().map(of_scan).collect();
    let density = means.iter().sum::<f64>() / scans;
    let standard_error = match &means[..] {
        [_] => density.abs() * (2.0 / spectra[0].bin_degrees_of_freedom(count)).sqrt(),
        means => {
            let squares: f64 = means.iter().map(|mean| (mean - density).powi(2)).sum();
            (squares / (scans - 1.0) / scans).sqrt()
        }
    };
    let wavenumbers: Vec<f64> = members.clone().map(|k| spectra[0].wavenumber(k)).collect();
    let logarithm = sum_of_logarithms(&wavenumbers).unwrap_or(f64::NAN);
    let log_bias = spectra.iter().map(|s| log_bias(s.degrees_of_freedom())).sum::<f64>() / scans;
    SpectrumBin {
        wavenumber: (logarithm / count as f64).exp(),
        density,
        standard_error,
        geometric_density: log_mean(spectra, members).map(|mean| (mean - log_bias).exp()),
        geometric_bias: log_bias.exp(),
        count,
    }
}

/// Mean of the logarithms of the densities; `None` if one is not positive.
fn log_mean(spectra: &[PowerSpectrum], members: std::ops::Range<usize>) -> Option<f64> {
    let of_scan = |s: &PowerSpectrum| sum_of_logarithms(&s.density[members.clone()]);
    let sum = spectra.iter().map(of_scan).sum::<Option<f64>>()?;
    Some(sum / (spectra.len() * members.len()) as f64)
}

/// Sum of the logarithms of some values; `None` if one is not positive.
fn sum_of_logarithms(values: &[f64]) -> Option<f64> {
    // One logarithm for eight values, by their product over the largest, which keeps within range: a
    // logarithm for each would take longer than the transform.
    let of_eight = |values: &[f64]| {
        if !values.iter().all(|&value| value > 0.0) {
            return None;
        }
        let largest = values.iter().copied().fold(0.0, f64::max);
        let product: f64 = values.iter().map(|value| value / largest).product();
        if product < f64::MIN_POSITIVE {
            return Some(values.iter().map(|value| value.ln()).sum());
        }
        Some(product.ln() + values.len() as f64 * largest.ln())
    };
    values.chunks(8).map(of_eight).sum()
}
