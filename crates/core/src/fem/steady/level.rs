//! The equations of the contact on one grid.

use super::block::Block;
use super::contact::Pairs;
use super::grid::Grid;
use super::long::{Long, Value};
use super::plate::Plate;
use super::row::Validity;
use super::state::{Heights, State};
use super::stiffness::{Positions, fix_x, pattern, touch};
use super::{BlockOptions, NotConverged, Setting, UpperEdge};
use crate::fem::profile::RigidProfile;
use crate::interface::LocalFriction;
use crate::multiscale::LocalLaw;
use crate::numerics::direct::{FactorError, SparseLu};
use std::f64::consts::PI;

/// The contact stiffness over the modulus of the block's shortest wave.
const STIFFNESS: f64 = 1.5;
/// Pressure at which the stiffness of a layer is read, over the largest of its law.
const LAYER_PRESSURE: f64 = 0.1;

/// The profile at the contact nodes.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    /// Height in m at each contact node.
    pub heights: Vec<f64>,
    pub slopes: Vec<f64>,
    pub scale: Heights,
}

impl Surface {
    pub fn new(profile: &RigidProfile, columns: usize) -> Self {
        let spacing = profile.period() / columns as f64;
        let points = (0..columns).map(|j| profile.at(j as f64 * spacing));
        let (heights, slopes) = points.map(|at| (at.height, at.slope)).unzip();
        Self { heights, slopes, scale: Heights::new(profile, 8 * columns) }
    }
}

/// Work spent.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Cost {
    pub newton_steps: usize,
    pub krylov_iterations: usize,
    pub factorisations: usize,
}

impl std::ops::Add for Cost {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            newton_steps: self.newton_steps + other.newton_steps,
            krylov_iterations: self.krylov_iterations + other.krylov_iterations,
            factorisations: self.factorisations + other.factorisations,
        }
    }
}

/// A block over a profile, with the preconditioner of its tangent.
pub(super) struct Level {
    pub block: Block,
    pub surface: Surface,
    pub cost: Cost,
    /// c of the contact in Pa.
    stiffness: f64,
    interface: LocalFriction,
    layer: Option<LocalLaw>,
    plate: Option<Plate>,
    positions: Positions,
    pub factors: SparseLu,
    /// Whether the factors belong to a state that is near enough.
    pub factored: bool,
    pub interrupt: crate::numerics::Interrupt,
    /// Whether steps towards a solution are taken with looser tolerances, for speed: on profiles of many scales, whose
    /// grids are large and whose pressures are far from the end of a path.
    pub in_haste: bool,
}

/// The residual of a state.
pub(super) struct Balance {
    pub residual: Vec<f64>,
    /// Root mean square of it over the contact nodes, over the mean contact force.
    pub norm: f64,
    pub validity: Validity,
    pub pairs: Pairs,
}

impl Level {
    pub fn new(setting: &Setting, options: &BlockOptions, profile: &RigidProfile) -> Self {
        let grid = Grid::new(options, profile.period());
        let shortest = PI * options.columns as f64 / profile.period() * setting.speed;
        let pattern = pattern(&grid);
        let positions = Positions::new(&grid, &pattern);
        let factors = SparseLu::analyse(pattern, &grid.coordinates());
        let modulus = setting.rubber.reduced_modulus(shortest).norm();
        // On a soft layer a node moves by more than the gap that it had: with the stiffness of both its unknown changes as
        // much beside the contact as in it, which Newton's method needs.
        let soft = setting.layer.as_ref().map(|law| {
            let pressure = LAYER_PRESSURE * law.largest_pressure();
            grid.spacing(0) * pressure / (law.touch_separation() - law.height(pressure))
        });
        let stiffness = (STIFFNESS * modulus).min(soft.unwrap_or(f64::INFINITY));
        let plated = options.upper_edge == UpperEdge::Plate;
        let plate = plated.then(|| Plate::new(&grid, modulus));
        Self {
            surface: Surface::new(profile, options.columns),
            cost: Cost::default(),
            stiffness,
            interface: setting.interface.clone(),
            layer: setting.layer.clone(),
            plate,
            positions,
            factors,
            factored: false,
            interrupt: setting.interrupt.clone(),
            in_haste: super::has_many_scales(profile),
            block: Block::new(grid, setting.material(profile.period())),
        }
    }

    pub fn grid(&self) -> &Grid {
        &self.block.grid
    }

    /// ε of the barrier `share` at a mean pressure: a share of the mean force times the roughness.
    fn barrier(&self, pressure: f64, share: f64) -> f64 {
        share * pressure * self.grid().spacing(0) * self.surface.scale.roughness
    }

    /// Forces and gaps of a state.
    pub fn pairs(&self, state: &State, barrier: f64) -> Pairs {
        Pairs::new(
            &Long::values(&state.contact),
            self.stiffness,
            self.barrier(state.pressure, barrier),
        )
        .sheared(&self.interface, self.grid().spacing(0))
        .on_layer(self.layer.as_ref(), self.grid().spacing(0))
    }

    /// The unknown of a node with this force in N/m and gap in m.
    pub fn unknown(&self, force: f64, gap: f64) -> f64 {
        force / self.stiffness - gap
    }

    /// An undeformed block above the profile, at the height where the barrier carries the load.
    pub fn above(&self, pressure: f64, barrier: f64) -> State {
        let grid = self.grid();
        let heights = &self.surface.heights;
        let length = barrier * self.surface.scale.roughness;
        let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let carried = |clearance: f64| {
            heights.iter().map(|z| length / (highest - z + clearance)).sum::<f64>()
        };
        // The highest node alone carries at least its share, all together no more than that.
        let nodes = heights.len() as f64;
        let (mut low, mut high) = (length / nodes, 2.0 * length);
        while high / low > 1.0 + 1e-12 {
            let middle = (low * high).sqrt();
            if carried(middle) > nodes { low = middle } else { high = middle }
        }
        let lift = highest + high;
        let mut displacements = vec![Long::default(); 2 * grid.nodes()];
        let layer = self.layer.as_ref().map_or(0.0, LocalLaw::touch_separation);
        displacements.iter_mut().skip(1).step_by(2).for_each(|z| *z = (lift + layer).into());
        let force = length * pressure * grid.spacing(0);
        let unknown = |z: &f64| self.unknown(force / (lift - z), lift - z).into();
        State { displacements, contact: heights.iter().map(unknown).collect(), pressure }
    }

    /// Moves the contact nodes to their gaps and returns the residual.
    pub fn balance(&mut self, state: &mut State, barrier: f64) -> Result<Balance, NotConverged> {
        let pairs = self.pairs(state, barrier);
        let gaps = pairs.gaps.iter().zip(&pairs.gap_slopes).zip(&state.contact);
        let heights = self.surface.heights.iter().zip(&pairs.layer);
        let nodes = state.displacements.chunks_exact_mut(2).zip(heights);
        for ((node, (height, layer)), ((gap, slope), tau)) in nodes.zip(gaps) {
            node[1] = Long::from(*height).plus(*layer).plus(*gap).plus(slope * tau.rest());
        }
        let (mut residual, validity) =
            self.block.deform(&state.displacements).map_err(|_| NotConverged)?;
        let contact = self.surface.slopes.iter().enumerate();
        for (node, (j, slope)) in residual.chunks_exact_mut(2).zip(contact) {
            let [along, up] = pairs.on_node(j, *slope);
            node[0] += along;
            node[1] -= up;
        }
        let upper = self.upper_edge();
        let load = state.pressure * self.grid().period / (upper.len() / 2) as f64;
        for node in residual[upper].chunks_exact_mut(2) {
            node[0] = 0.0;
            node[1] += load;
        }
        if let Some(plate) = &self.plate {
            plate.add(&state.displacements, &mut residual);
        }
        let norm = self.norm(&residual, state.pressure);
        if norm.is_finite() {
            Ok(Balance { residual, norm, validity, pairs })
        } else {
            Err(NotConverged)
        }
    }

    fn norm(&self, residual: &[f64], pressure: f64) -> f64 {
        let nodes = self.grid().contact_nodes() as f64;
        let force = pressure * self.grid().spacing(0);
        crate::numerics::krylov::euclidean_norm(residual) / (force * nodes.sqrt())
    }

    /// The entries of the upper edge, whose x displacements are not unknowns.
    pub fn upper_edge(&self) -> std::ops::Range<usize> {
        let grid = self.grid();
        2 * grid.first_node(grid.rows())..2 * grid.nodes()
    }

    /// Change of the residual by that of the unknowns: displacements, but τ for z at the contact.
    pub fn tangent(&self, pairs: &Pairs, changes: &[f64]) -> Vec<f64> {
        let mut displacements = changes.to_vec();
        for (node, slope) in displacements.chunks_exact_mut(2).zip(&pairs.gap_slopes) {
            node[1] *= slope;
        }
        let upper = self.upper_edge();
        displacements[upper.clone()].iter_mut().step_by(2).for_each(|x| *x = 0.0);
        let mut forces = self.block.tangent(&displacements);
        for (j, slope) in self.surface.slopes.iter().enumerate() {
            let [along, up] = pairs.on_node_slopes(j, *slope);
            forces[2 * j] += along * changes[2 * j + 1];
            forces[2 * j + 1] -= up * changes[2 * j + 1];
        }
        if let Some(plate) = &self.plate {
            plate.add(&displacements, &mut forces);
        }
        let fixed = forces[upper.clone()].iter_mut().step_by(2);
        fixed
            .zip(changes[upper].iter().step_by(2))
            .for_each(|(force, x)| *force = self.stiffness * x);
        forces
    }

    /// Factorises the local tangent at the last deformed state.
    pub fn factorise(&mut self, pairs: &Pairs) -> Result<(), NotConverged> {
        self.factored = false;
        if self.interrupt.is_set() {
            return Err(NotConverged);
        }
        let pattern = self.factors.pattern();
        let mut values = self.positions.assemble(&self.block, pattern);
        let slopes = pairs.gap_slopes.iter().zip(&self.surface.slopes).enumerate();
        let contact: Vec<[f64; 3]> = slopes
            .map(|(j, (gap, slope))| {
                let [along, up] = pairs.on_node_slopes(j, *slope);
                [*gap, along, -up]
            })
            .collect();
        if let Some(plate) = &self.plate {
            plate.add_to(pattern, &mut values);
        }
        touch(pattern, &mut values, &contact);
        fix_x(pattern, &mut values, self.upper_edge().start / 2, self.stiffness);
        self.cost.factorisations += 1;
        let factored: Result<(), FactorError> = self.factors.refactor(&values, &self.interrupt);
        factored.map_err(|_| NotConverged)?;
        self.factored = true;
        Ok(())
    }
}
