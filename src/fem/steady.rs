//! Steady sliding contact: experiment.

use super::block::Block;
use super::filter::Filter;
use super::local::{LocalPattern, NodeStiffness};
use super::mesh::Mesh;
use super::profile::{Height, RigidProfile};
use super::row::Material;
use super::unknowns::Unknowns;
use crate::numerics::krylov::{KrylovLimits, euclidean_norm, gmres};
use crate::rubber::FiniteStrainRubber;

pub struct Steady {
    pub block: Block,
    pub pattern: LocalPattern,
    pub profile: RigidProfile,
    pub unknowns: Unknowns,
    pub log: bool,
}

#[derive(Clone, Debug)]
pub struct State {
    pub nodes: Vec<f64>,
    pub force: Vec<f64>,
    pub gap: Vec<f64>,
    pub pressure: f64,
    pub friction: f64,
    pub newton: usize,
    pub krylov: usize,
}

struct Residual {
    reduced: Vec<f64>,
    internal: Vec<f64>,
    places: Vec<Height>,
    gap_error: Vec<f64>,
    norm: f64,
}

impl Steady {
    pub fn new(rubber: &FiniteStrainRubber, speed: f64, profile: RigidProfile, mesh: Mesh) -> Self {
        let lengths: Vec<f64> = rubber.branches.iter().map(|b| speed * b.relaxation_time).collect();
        let filters = lengths.iter().map(|l| Filter::new(mesh.spacing(), *l)).collect();
        let material = Material { rubber: rubber.clone(), filters };
        let unknowns = Unknowns { columns: mesh.columns, rows: mesh.rows() };
        let block = Block::new(mesh, material);
        let t = std::time::Instant::now();
        let pattern = LocalPattern::new(&block, &lengths);
        if std::env::var("LOG").is_ok() {
            eprintln!("pattern {:?}", t.elapsed());
        }
        Self { block, pattern, profile, unknowns, log: std::env::var("LOG").is_ok() }
    }

    pub fn start(&self, pressure: f64) -> State {
        let n = self.unknowns.columns;
        let h = self.block.mesh().spacing();
        let zs = self.profile.sample(n);
        let max = zs.iter().cloned().fold(f64::MIN, f64::max);
        let min = zs.iter().cloned().fold(f64::MAX, f64::min);
        let lift = max + 0.1 * (max - min);
        let mut nodes = vec![0.0; self.block.len()];
        nodes.iter_mut().skip(1).step_by(2).for_each(|z| *z = lift);
        let gap: Vec<f64> = zs.iter().map(|z| lift - z).collect();
        let mean = gap.iter().sum::<f64>() / n as f64;
        let force = gap.iter().map(|g| pressure * h * mean / g).collect();
        State { nodes, force, gap, pressure, friction: 0.0, newton: 0, krylov: 0 }
    }

    fn residual(&mut self, state: &State, pressure: f64) -> Option<Residual> {
        let internal = self.block.deform(&state.nodes).ok()?;
        let n = self.unknowns.columns;
        let h = self.block.mesh().spacing();
        let mut forces = internal.clone();
        let upper = self.unknowns.upper_edge();
        for j in 0..n {
            forces[upper + 2 * j + 1] += pressure * h;
        }
        let mut places = Vec::with_capacity(n);
        let mut gap_error = Vec::with_capacity(n);
        for j in 0..n {
            let x = j as f64 * h + state.nodes[2 * j];
            let at = self.profile.at(x);
            forces[2 * j] += state.force[j] * at.slope;
            forces[2 * j + 1] -= state.force[j];
            gap_error.push(state.nodes[2 * j + 1] - at.height - state.gap[j]);
            places.push(at);
        }
        let reduced =
            self.unknowns.reduce(&forces, self.unknowns.mean_contact_displacement(&state.nodes));
        let norm =
            euclidean_norm(&reduced[..self.unknowns.own()]) / (pressure * h * (n as f64).sqrt());
        Some(Residual { reduced, internal, places, gap_error, norm })
    }

    pub fn solve(
        &mut self,
        state: &State,
        pressure: f64,
        sigma_start: f64,
        end: f64,
        tol: f64,
    ) -> Option<State> {
        let n = self.unknowns.columns;
        let h = self.block.mesh().spacing();
        let mut st = state.clone();
        st.newton = 0;
        st.krylov = 0;
        let zs = self.profile.sample(n);
        let range = zs.iter().cloned().fold(f64::MIN, f64::max)
            - zs.iter().cloned().fold(f64::MAX, f64::min);
        let end = end * range;
        let sigma_start = sigma_start * range;
        let mut sigma = sigma_start;
        let t0 = std::time::Instant::now();
        let (mut ta, mut tk) = (0.0, 0.0);
        let mut res = self.residual(&st, pressure)?;
        for it in 0..120 {
            let s = sigma * pressure * h;
            // reduced system
            let t = std::time::Instant::now();
            let mut contact: Vec<NodeStiffness> = Vec::with_capacity(n);
            let mut rhs: Vec<f64> = res.reduced.iter().map(|r| -r).collect();
            for j in 0..n {
                let (lam, w, at) = (st.force[j], st.gap[j], res.places[j]);
                let nrm = [-at.slope, 1.0];
                let k = lam / w;
                contact.push([
                    [k * nrm[0] * nrm[0] + lam * at.curvature, k * nrm[0]],
                    [k * nrm[0], k],
                ]);
                let push = s / w - lam - k * res.gap_error[j];
                rhs[2 * j] += nrm[0] * push;
                rhs[2 * j + 1] += push;
            }
            let pre = self.pattern.factorise(&self.block, &contact)?;
            ta += t.elapsed().as_secs_f64();
            let t = std::time::Instant::now();
            pre.solve(&mut rhs);
            let norm0 = euclidean_norm(&rhs);
            let unknowns = self.unknowns;
            let block = &self.block;
            let apply = |x: &[f64], out: &mut [f64]| {
                let du = unknowns.expand(x);
                let mut f = block.tangent(&du);
                for j in 0..n {
                    let (dx, dz) = (du[2 * j], du[2 * j + 1]);
                    f[2 * j] += contact[j][0][0] * dx + contact[j][0][1] * dz;
                    f[2 * j + 1] += contact[j][1][0] * dx + contact[j][1][1] * dz;
                }
                let r = unknowns.reduce(&f, unknowns.mean_contact_displacement(&du));
                out.copy_from_slice(&r);
                pre.solve(out);
            };
            let rep = gmres(
                apply,
                &mut rhs,
                KrylovLimits { tolerance: tol * norm0, max_iterations: 300 },
            );
            tk += t.elapsed().as_secs_f64();
            st.krylov += rep.iterations;
            st.newton += 1;
            let du = unknowns.expand(&rhs);
            // steps of slack and force
            let mut dw = vec![0.0; n];
            let mut dl = vec![0.0; n];
            let (mut aw, mut al) = (1.0f64, 1.0f64);
            for j in 0..n {
                let (lam, w, at) = (st.force[j], st.gap[j], res.places[j]);
                dw[j] = res.gap_error[j] - at.slope * du[2 * j] + du[2 * j + 1];
                dl[j] = (s - lam * w - lam * dw[j]) / w;
                if dw[j] < 0.0 {
                    aw = aw.min(-0.98 * w / dw[j]);
                }
                if dl[j] < 0.0 {
                    al = al.min(-0.98 * lam / dl[j]);
                }
            }
            let mut a = aw.min(al);
            let largest =
                du[..self.unknowns.upper_edge()].iter().fold(0.0f64, |m, d| m.max(d.abs()));
            let period = self.block.mesh().period;
            if a * largest > 0.1 * period {
                a = 0.1 * period / largest;
            }
            let old = st.clone();
            let mut ok = false;
            for _ in 0..12 {
                for i in 0..st.nodes.len() {
                    st.nodes[i] = old.nodes[i] + a * du[i];
                }
                for j in 0..n {
                    st.gap[j] = old.gap[j] + a * dw[j];
                    st.force[j] = old.force[j] + a * dl[j];
                }
                if let Some(r) = self.residual(&st, pressure) {
                    let growth = if it < 5 { 10.0 } else { 2.0 };
                    if r.norm < growth * res.norm.max(1e-1) {
                        res = r;
                        ok = true;
                        break;
                    }
                }
                a *= 0.5;
            }
            if !ok {
                if self.log {
                    eprintln!("line search failed at sigma {sigma:.2e}");
                }
                return None;
            }
            let comp = (0..n).map(|j| (st.force[j] * st.gap[j] - s).abs()).fold(0.0, f64::max) / s;
            let gerr = res.gap_error.iter().fold(0.0f64, |m, g| m.max(g.abs())) / range;
            if self.log {
                eprintln!(
                    "it {it} sigma {:.1e} krylov {} step {a:.3} res {:.2e} comp {comp:.1e} gap {gerr:.1e} U {:.3}",
                    sigma / range,
                    rep.iterations,
                    res.norm,
                    st.nodes[self.unknowns.upper_edge()] / period
                );
            }
            let final_ = end < 1e-7 * range;
            let small = if final_ {
                res.norm < 1e-8 && gerr < 1e-10
            } else {
                res.norm < 1e-3 && gerr < 1e-3
            };
            if small && comp < 1.0 && sigma <= end * 1.0001 {
                st.pressure = pressure;
                st.friction = -(0..n).map(|j| st.force[j] * res.places[j].slope).sum::<f64>()
                    / (pressure * period)
                    * -1.0;
                if self.log {
                    eprintln!(
                        "time {:.3} assembly+lu {ta:.3} krylov {tk:.3}",
                        t0.elapsed().as_secs_f64()
                    );
                }
                return Some(st);
            }
            if res.norm < 0.1 * (sigma / range).min(1.0).max(1e-8) && comp < 0.9
                || (res.norm < 1e-9 && comp < 1.0)
            {
                sigma = (sigma
                    * if sigma > 1e-3 * range {
                        std::env::var("FAC").map(|f| f.parse().unwrap()).unwrap_or(0.3)
                    } else {
                        0.1
                    })
                .max(end);
            }
        }
        None
    }
}
