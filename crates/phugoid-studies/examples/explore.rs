use phugoid_studies::detection::*; use phugoid_studies::scenario::Scenario; use phugoid_identification::model_file::ModelFile;
fn main(){
 let a:Vec<String>=std::env::args().collect(); let n:usize=a[2].parse().unwrap(); let seed:u64=a[3].parse().unwrap();
 let base=Scenario::parse(phugoid_studies::published::DAMAGE_SCENARIO,"d").unwrap();
 let mut text=include_str!("../../../data/models/f16.toml").to_owned();
 if a[1].contains('o'){ text=text.replace("[coefficients]","[coefficients]\noffsets = true"); }
 if a[1].contains('q'){ text=text.replace("\"elevator\"]","\"elevator\", \"alpha^2\"]").replace("dCm_elevator =","dCm_alpha2 = { bounds = [-4, 4], prior_std = 1, change_std = 0 }\ndCm_elevator ="); }
 let model=ModelFile::parse("f16",&text).unwrap();
 if a[1].contains('b'){ for l in damage_lines(&base,&model,n,seed,&||{}).unwrap(){
  println!("{:?} {:?} {} doubt {:.2?} adopt {:.2?} informed {:.2?} missed {} {:?} false {} extra {}",l.air,l.stick,l.damage_at_s,l.doubt_s,l.adoption_s,l.informed_s,l.missed,l.missed_seeds,l.false_before,l.extra);
  for r in &l.recovery{ print!("   +{}: {:.2}/{:.2} med {:.4} cov {:.2} ({:.2});",r.after_s,r.median_over_oracle,r.ninety_over_oracle,r.median,r.coverage,r.oracle_coverage);} println!(); }}
 if a[1].contains('c'){ for l in model_error_lines(&base,&model,n,seed,&||{}).unwrap(){
  println!("{} {:?} {} min: {} adoptions {:.2}/10min {:.2?} harmful {} claimed {} doubts {} insens {} err {:.3?} cov {:.2?} {:?}",l.error,l.air,l.minutes,l.adoptions,l.per_ten_minutes,l.interval,l.harmful,l.harmful_and_claimed,l.doubts,l.insensitive,l.error_at_end,l.coverage_at_end,l.seeds);}}
}
