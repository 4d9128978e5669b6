//! A design's proof as rows: claims beside what was recomputed, vehicles of a range, controllers with fewer states, gains.

use super::design_outcome::{DesignOutcome, DesignVertex, Measured};
use super::{DesignMethod, Rms};

/// A number that the synthesis claims, and the same from vehicle and controller alone.
#[derive(Debug, Clone, PartialEq)]
pub struct ClaimRow {
    /// In words.
    pub words: String,
    /// As claimed.
    pub claimed: f64,
    /// Recomputed; none where there is nothing to recompute.
    pub recomputed: Option<f64>,
    /// Empty of a pure number.
    pub unit: String,
    /// Whether it counts something.
    pub is_count: bool,
}

/// One quantity of all vehicles of a range.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexTable {
    /// Which, in words.
    pub quantity: String,
    /// Its unit; empty of a pure number.
    pub unit: String,
    /// One a vehicle.
    pub rows: Vec<VertexRow>,
}

/// A vehicle of a range.
#[derive(Debug, Clone, PartialEq)]
pub struct VertexRow {
    /// Its fields that differ; a middle says so.
    pub place: String,
    /// Without control.
    pub passive: Option<f64>,
    /// With the gain of the vehicle as stated.
    pub nominal: Option<f64>,
    /// With the controller of all of them.
    pub robust: Option<f64>,
}

/// A controller with states left out; the whole one is the first.
#[derive(Debug, Clone, PartialEq)]
pub struct TruncatedRow {
    /// States.
    pub order: usize,
    /// Of its loop.
    pub stable: bool,
    /// The goal's value.
    pub objective: Option<f64>,
    /// The largest of the bounded gains over its bound.
    pub over_bound: Option<f64>,
}

/// A row of a gain without states.
#[derive(Debug, Clone, PartialEq)]
pub struct GainRow<'a> {
    /// The measurement.
    pub name: &'a str,
    /// Of the gain: N per unit of the measurement.
    pub unit: String,
    /// To each actuator.
    pub values: Vec<f64>,
}

impl DesignOutcome {
    /// What is claimed, and the same recomputed beside it.
    #[must_use]
    pub fn claim_rows(&self) -> Vec<ClaimRow> {
        let is_second =
            |name: &str| name.strip_suffix("_recomputed").is_some_and(|n| self.claimed.get(n).is_some());
        let row = |(name, claimed): (&str, &f64)| {
            let (words, unit) = self.claim_words(name);
            let recomputed = self.claimed.get(&format!("{name}_recomputed")).copied();
            ClaimRow { words, claimed: *claimed, recomputed, unit, is_count: name.starts_with("iterations") }
        };
        self.claimed.iter().filter(|(name, _)| !is_second(name)).map(row).collect()
    }

    /// The vehicles of a range: the goal's value, then rms and bounded gains of the goal's outputs.
    #[must_use]
    pub fn vertex_tables(&self) -> Vec<VertexTable> {
        if self.vertices.is_empty() {
            return Vec::new();
        }
        let place = |v: &DesignVertex| {
            let fields: Vec<String> = v.at.iter().map(|(n, x)| format!("{n} = {x}")).collect();
            let middle = if v.corner { "" } else { " (the middle)" };
            if fields.is_empty() { "as stated".to_owned() } else { fields.join(", ") + middle }
        };
        let table = |quantity: String, unit: String, of: &dyn Fn(&DesignVertex) -> [Option<f64>; 3]| {
            let row = |v: &DesignVertex| {
                let [passive, nominal, robust] = of(v);
                VertexRow { place: place(v), passive, nominal, robust }
            };
            VertexTable { quantity, unit, rows: self.vertices.iter().map(row).collect() }
        };
        let each = |v: &DesignVertex, of: &dyn Fn(&Measured) -> Option<f64>| {
            [of(&v.passive), v.nominal.as_ref().and_then(of), of(&v.closed)]
        };
        let unit = |name: &str| self.units.get(name).cloned().unwrap_or_default();
        let mut tables = Vec::new();
        if !self.objective.is_empty() {
            let of = |v: &DesignVertex| ["passive", "nominal", "closed"].map(|k| v.objective.get(k).copied());
            tables.push(table("the goal's value".into(), String::new(), &of));
        }
        for (name, _) in self.design.weights().unwrap_or_default().iter() {
            let of = |v: &DesignVertex| each(v, &|m| m.rms.get(name).and_then(|r| Rms::finite(*r)));
            tables.push(table(format!("rms of {name}"), unit(name), &of));
        }
        for part in self.design.hinf_parts().unwrap_or_default() {
            let of = |v: &DesignVertex| each(v, &|m| m.hinf.get(&part.name).copied());
            let unit = format!("{} per {}", unit(&part.name), self.per());
            tables.push(table(format!("largest gain of {}", part.name), unit, &of));
        }
        tables
    }

    /// The controller and what is left of it with fewer states.
    #[must_use]
    pub fn truncated_rows(&self) -> Vec<TruncatedRow> {
        let (Some(verified), Some(order)) = (&self.verified, self.order) else { return Vec::new() };
        if self.truncated.is_empty() {
            return Vec::new();
        }
        let row = |order, objective, m: &Measured| {
            let parts = self.design.hinf_parts().unwrap_or_default();
            let over = parts
                .iter()
                .filter(|p| p.bound.is_some())
                .filter_map(|p| Some(m.hinf.get(&p.name)? / self.claimed.get(&format!("hinf_{}", p.name))?));
            let squared = self.design.goal.bound_h2.iter().filter_map(|(name, _)| {
                let claimed = self.claimed.get(&format!("h2_{name}"))?;
                Some(m.h2.get(name)?.finite()? / claimed)
            });
            let over = over.chain(squared);
            TruncatedRow { order, stable: m.stable, objective, over_bound: over.reduce(f64::max) }
        };
        let whole = row(order, self.objective.get("verified").copied(), verified);
        std::iter::once(whole)
            .chain(self.truncated.iter().map(|t| row(t.order, t.objective, &t.verified)))
            .collect()
    }

    /// The rows of a controller without states: what each measurement does to each actuator.
    #[must_use]
    pub fn gain_rows(&self) -> Vec<GainRow<'_>> {
        let Some(k) = self.controller.as_ref().filter(|k| k.a.is_empty()) else { return Vec::new() };
        let unit = |name: &str| self.units.get(name).map_or("unit", String::as_str).to_owned();
        k.inputs
            .iter()
            .enumerate()
            .map(|(j, name)| GainRow {
                name,
                unit: format!("N per {}", unit(name)),
                values: k.d.iter().filter_map(|r| r.get(j).copied()).collect(),
            })
            .collect()
    }

    /// The word for what a controller's inputs are.
    #[must_use]
    pub fn measures_words(&self) -> &'static str {
        if self.design.method == DesignMethod::RobustStateFeedback { "states" } else { "measuring" }
    }
}
