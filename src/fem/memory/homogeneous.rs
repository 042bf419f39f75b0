//! One row of a homogeneous block in Fourier space.

use super::Block2;
use crate::fem::block::Block;
use crate::fem::mesh::{CENTRE, Element};
use crate::rubber::finite_strain::{Measure, Symmetric, inverse, one_plus, sandwich};
use rustfft::num_complex::Complex64;

/// Forces on the lower and the upper row of nodes by displacements of both.
#[derive(Clone, Copy)]
pub(super) struct RowStiffness(pub [[Block2; 2]; 2]);

/// The mean state of a row of elements.
pub(super) struct MeanState {
    deformation: [f64; 4],
    measure: Measure,
    inverse: Symmetric,
}

impl MeanState {
    /// The state with a vertical slope of the mean displacements, at rest.
    pub fn new(block: &Block, shear: f64) -> Self {
        let rubber = &block.material().rubber;
        // At constant volume and without stress: row means of a contact that is strongly deformed
        // would have a pressure that is nowhere in the row.
        let deformation = [1.0, shear, 0.0, 1.0];
        let strain = [0.0, shear * shear, shear];
        let measure = rubber.rheology.measure(&strain).expect("det C is one");
        Self { deformation, measure, inverse: inverse(&one_plus(&strain)) }
    }

    /// Stiffness of a row at one wavenumber with complex moduli μ and c.
    pub fn stiffness(&self, element: &Element, angle: f64, moduli: [Complex64; 2]) -> RowStiffness {
        let phase = Complex64::cis(angle);
        let mut stiffness = RowStiffness([[Block2::zeros(); 2]; 2]);
        let f = &self.deformation;
        for (kind, gradients) in element.gradients.iter().enumerate() {
            let weight = element.weights[kind];
            let gradient = [0, 2]
                .map(|node| [0, 1].map(|c| gradients[node][c] + gradients[node + 1][c] * phase));
            for (from, by) in gradient.iter().enumerate() {
                for direction in 0..2 {
                    // δF = e_direction ⊗ gradient.
                    let row = [f[2 * direction], f[2 * direction + 1]];
                    let strain = [
                        2.0 * row[0] * by[0],
                        2.0 * row[1] * by[1],
                        row[0] * by[1] + row[1] * by[0],
                    ];
                    let stress = if kind == CENTRE {
                        let trace = self.inverse[0] * strain[0]
                            + self.inverse[1] * strain[1]
                            + 2.0 * self.inverse[2] * strain[2];
                        self.inverse.map(|g| moduli[1] * trace * g)
                    } else {
                        self.shear_change(&strain).map(|s| moduli[0] * s)
                    };
                    for i in 0..2 {
                        let traction = [
                            f[2 * i] * stress[0] + f[2 * i + 1] * stress[2],
                            f[2 * i] * stress[2] + f[2 * i + 1] * stress[1],
                        ];
                        for (to, test) in gradient.iter().enumerate() {
                            stiffness.0[to][from][(i, direction)] += weight
                                * (traction[0] * test[0].conj() + traction[1] * test[1].conj());
                        }
                    }
                }
            }
        }
        stiffness
    }

    /// Change of the stress of the shear part with modulus one by that of `C`.
    fn shear_change(&self, strain: &[Complex64; 3]) -> [Complex64; 3] {
        let real = |x: &Symmetric| match &self.measure {
            Measure::Green(_) => sandwich(&self.inverse, x),
            // The linear law without stress: from C to ln C and back.
            measure => measure.derivative(&measure.derivative(x)),
        };
        let (re, im) = (real(&strain.map(|x| x.re)), real(&strain.map(|x| x.im)));
        [0, 1, 2].map(|i| Complex64::new(re[i], im[i]))
    }
}
