//! The jobs as data: a specification goes in, an outcome comes out, both serialisable.
//!
//! A command line, a Python module and a web page all fill in a [`Spec`] and show an outcome; none of them computes.

mod beyond_band;
mod bump_metrics;
mod checked_design;
mod checked_result;
mod compare;
mod compare_modes;
mod compare_outcome;
mod controller_files;
mod damping;
mod demo;
mod demo_designs;
mod demo_drive;
mod demo_outcome;
mod demo_road;
mod design;
mod design_actuator;
mod design_advice;
mod design_beside;
mod design_blocks;
mod design_bode;
mod design_controller_changes;
mod design_fixed_active;
mod design_fixed_confirm;
mod design_fixed_member;
mod design_fixed_order;
mod design_fixed_outcome;
mod design_fixed_rows;
mod design_fixed_search;
mod design_fixed_spec;
mod design_fixed_starts;
mod design_fixed_structure;
mod design_fixed_words;
mod design_fragile;
mod design_gains;
mod design_goal;
mod design_goal_norms;
mod design_homes;
mod design_interpolation;
mod design_limit_loop;
mod design_limits;
mod design_measure;
mod design_methods;
mod design_metric_rows;
mod design_metrics;
mod design_mixed;
mod design_mixed_spec;
mod design_outcome;
mod design_outputs;
mod design_pairs;
mod design_problem;
mod design_proof_rows;
mod design_responses;
mod design_robust;
mod design_robustness;
mod design_robustness_rows;
mod design_rows;
mod design_search;
mod design_smallest;
mod design_spec;
mod design_states;
mod design_truncated;
mod design_vehicle;
mod design_warnings;
mod design_words;
mod drives;
mod envelope;
mod error;
mod fit_generic;
mod ground;
mod identify;
mod identify_agreement;
mod identify_evidence;
mod identify_operational;
mod identify_outcome;
mod identify_physical;
mod identify_tvimm;
mod input_checks;
mod interpolation;
mod interpolation_file;
mod json_path;
mod load;
mod modes;
mod named;
mod new_file;
mod number_table;
mod parts;
mod physical_inputs;
mod physical_notes;
mod profile_file;
mod reproduce;
mod respond;
mod ride;
mod ride_metrics;
mod road_analytic;
mod road_analytic_data;
mod road_fit;
mod road_fit_cross;
mod road_fit_file;
mod road_fit_filter;
mod road_fit_order;
mod road_fit_settings;
mod road_fit_source;
mod road_fit_ways;
mod road_fit_words;
mod road_iri;
mod road_profile;
mod road_profile_ends;
mod road_spec;
mod sensors;
mod shape_points;
mod simulate;
mod spec;
mod spectra_plot;
mod spectrum_file;
mod spectrum_noise;
mod spectrum_smooth;
mod speed_parts;
mod sweep;
mod sweep_directory;
mod sweep_grid;
mod sweep_merge;
mod sweep_outcome;
mod sweep_pareto;
mod sweep_plan;
mod sweep_spec;
mod sweep_table;

pub use crate::vehicle::Stretch;
pub use beyond_band::BeyondBand;
pub use bump_metrics::{BumpMetrics, BumpSpec};
pub use checked_design::read_design;
pub use checked_result::read_identification;
pub use compare::{compare, compare_outcomes};
pub use compare_outcome::*;
pub use controller_files::{controller_files, mat5, read_controller};
pub use damping::{DampingOnRoad, DampingOutcome, EquivalentDamper, damping};
pub use demo::{DemoRun, demo};
pub use demo_outcome::*;
pub use design::design;
pub use design_actuator::{ActuatorLoop, ActuatorSection, Reach};
pub use design_bode::{BodeCurve, InvariantPoint};
pub use design_fixed_outcome::*;
pub use design_fixed_rows::{SearchRow, TargetRow};
pub use design_fixed_spec::{
    FixedOrderSection, FreeEntry, LocalSection, StructureEntry, StructureKind, StructureSpec,
};
pub use design_goal::Goal;
pub use design_limit_loop::DesignLimit;
pub use design_metric_rows::{MetricGroup, MetricRow};
pub use design_metrics::{DesignMetrics, MetricsSection};
pub use design_mixed_spec::{LyapunovScaleSpec, MixedSection, PolesSection};
pub use design_outcome::*;
pub use design_proof_rows::{ClaimRow, GainRow, TruncatedRow, VertexRow, VertexTable};
pub use design_responses::{DesignResponses, TimeResponses};
pub use design_robustness::{Perturbed, PerturbedKind, Robustness};
pub use design_robustness_rows::RobustnessRow;
pub use design_rows::{ResponseGroup, ResponseRow};
pub use design_spec::*;
pub use design_vehicle::{DesignVehicle, DesignWheel};
pub use envelope::{Envelope, Input, SCHEMA_VERSION, is_result_of, read_result};
pub use error::StudyError;
pub use identify::{Files, IdentifyRun, identify, identify_recording, identify_recordings};
pub use identify_evidence::*;
pub use identify_outcome::*;
pub use interpolation::{
    InterpolateOutcome, InterpolateSpec, InterpolateStatus, check_interpolation_target, interpolate_file,
};
pub use load::{
    LoadedExcitation, LoadedFilter, LoadedRoad, LoadedVehicle, load_excitation, load_road, load_vehicle,
};
pub use modes::{ModesOutcome, VehicleMode, VehicleModeKind, modes};
pub use named::Named;
pub use reproduce::{
    Check, Counts, Curve, Erratum, Evidence, Figure, Listed, Relation, ReproduceError, ReproduceOutcome,
    ReproduceSpec, Titled, all_errata, chapter_of, errata_markdown, lmi_cars, number_text, reproduce,
    reproducible, reproducible_list,
};
pub use respond::{BumpOutcome, Direction, GainsOutcome, RespondOutcome, respond};
pub use ride::{Infinite, RideOutcome, RideSpectra, Rms, ride};
pub use ride_metrics::{ActuatorUse, RideMetrics, TireLoad, TravelUse, VibrationTotal, WeightedAcceleration};
pub use road_analytic::{AnalyticSamples, RoadAnalyticOutcome, RoadAnalyticRun, road_analytic};
pub use road_fit::{FitOrder, FittedSpectrum, RoadFitOutcome, RoadFitRun, road_fit};
pub use road_fit_cross::CrossError;
pub use road_fit_source::FitSource;
pub use road_iri::{RoadIriOutcome, SegmentIri, TrackIri, road_iri};
pub use road_profile::{ProfileTrack, RoadProfileOutcome, RoadProfileRun, road_profile};
pub use road_spec::{
    DensityConvention, FitWeight, RoadAnalyticSpec, RoadFitSpec, RoadIriSpec, RoadProfileSpec,
};
pub use sensors::{SensorRow, SensorsFile};
pub use simulate::{
    DriveTruth, DrivenStretch, SimulateOutcome, SimulateRun, SimulatedChannel, TrueNoise, simulate,
};
pub use spec::{
    CompareSpec, DampingSpec, DemoSpec, IdentifyMethod, IdentifySpec, ModesSpec, RespondSpec, RideSpec,
    SimulateSpec, Spec,
};
pub use sweep::{Shard, SweepProgress, sweep};
pub use sweep_directory::{SweepDirectory, SweepFile, point_name};
pub use sweep_merge::{MergedSweep, merge, point_list};
pub use sweep_outcome::{
    PointDesign, PointFile, PointResult, PointStamp, SweepDetail, SweepOutcome, SweepPoint, SweepStatus,
};
pub use sweep_pareto::non_dominated;
pub use sweep_plan::{PlannedPoint, SweepPlan, SweepSeal};
pub use sweep_spec::{SweepAxis, SweepSpec};
pub use sweep_table::{Cell, SweepTable};
