// The sentence of a report, which is read before anything else
#include <gtest/gtest.h>

#include "host/identify/candidates/candidate.hpp"
#include "host/identify/report/report.hpp"

namespace pvg::diagnose {
namespace {

Candidate candidate(const std::string& name, Family family) {
  Candidate one;
  one.name = name;
  one.target = "tip";
  one.family = family;
  return one;
}

Diagnosis heavy(const Candidate& mass) {
  Diagnosis d;
  d.verdict = Verdict::retune;
  d.effects = {{&mass, {{"value", "kg", 0.56, 0.54, 0.58}}}};
  d.unit = "noise";
  d.before = 10.8, d.after = 2.33, d.floor = 1;
  return d;
}

TEST(Sentence, NamesWhatWasFoundWithItsValueAndTheProof) {
  const Candidate mass = candidate("retune_mass", Family::parameter);
  EXPECT_EQ(sentence_of(heavy(mass)),
            "wrong in the scene: retune_mass at tip, value 0.56 +- 0.01 kg; the held-out error falls from 10.8 to 2.33 "
            "times the noise, noise floor 1; partly explained: 2.33 times the noise is left");
}

TEST(Sentence, SaysWhatTheDataCannotTellApart) {
  const Candidate mass = candidate("retune_mass", Family::parameter);
  Diagnosis d = heavy(mass);
  d.inseparable = {{"actuator_gain at shaft", "retune_mass at tip"}, {"bias at q", "clock_offset at recording"}};
  EXPECT_NE(sentence_of(d).find("kg (these data cannot tell it from actuator_gain at shaft); the held-out"),
            std::string::npos);
  d.inseparable = {{"a at b", "c at d", "e at f", "g at h", "i at j", "retune_mass at tip"}};
  EXPECT_NE(sentence_of(d).find("cannot tell it from a at b or c at d or e at f or 2 others)"), std::string::npos);
}

TEST(Sentence, SaysWhereOnlyTheFittedRunsDoNotAgree) {
  const Candidate mass = candidate("retune_mass", Family::parameter);
  Diagnosis d = heavy(mass);
  d.verdict = Verdict::none;
  d.fit_before = 2.8;
  EXPECT_NE(sentence_of(d).find("best, but not enough: retune_mass at tip, the held-out error falls from 10.8"),
            std::string::npos);
  d.before = 1.9, d.after = 5.3;
  EXPECT_NE(sentence_of(d).find("the held-out error rises from 1.9 to 5.3"), std::string::npos);
  d.before = 1.1, d.after = 1.05;
  EXPECT_EQ(sentence_of(d),
            "none of the known effects explains the misfit of 2.8 times the noise; the held-out runs agree with the "
            "scene as it stands: their error is 1.1 times the noise, noise floor 1");
}

TEST(Sentence, SaysWhyThereIsNoProof) {
  const Candidate mass = candidate("retune_mass", Family::parameter);
  Diagnosis d = heavy(mass);
  d.floor = 0;
  EXPECT_NE(sentence_of(d).find("; no run was held out to prove it on"), std::string::npos);
  d.whole.why_not = "the held-out runs were not judged";
  EXPECT_NE(sentence_of(d).find("; the held-out runs were not judged"), std::string::npos);
}

// Runs that agree because of a noise that nobody knows agree with nothing.
TEST(Sentence, OfAnUnknownNoiseSaysWhatWouldBeNamedWithLess) {
  const Candidate mass = candidate("retune_mass", Family::parameter);
  Diagnosis d = heavy(mass);
  d.supposed_noise =
      "the noise of the position of joint hinge is unknown: with 0.02 rad scene and runs agree, with "
      "0.001 rad";
  d.supposed_verdict = d.verdict;
  d.verdict = Verdict::none;
  EXPECT_EQ(
      sentence_of(d),
      d.supposed_noise +
          ": wrong in the scene: retune_mass at tip, value 0.56 +- 0.01 kg; the held-out error "
          "falls from 10.8 to 2.33 times the noise, noise floor 1; partly explained: 2.33 times the noise is left");
}

TEST(Sentence, DoubtsAGravityThatIsNowhereOnEarth) {
  const Candidate gravity = candidate("retune_gravity", Family::parameter);
  Diagnosis d = heavy(gravity);
  d.used.gravity = Vec3(0, 0, -9.81);
  const auto has_doubt = [&](double value, double deviation) {
    d.effects[0].parameters = {{"value", "m/s^2", value, value - 2 * deviation, value + 2 * deviation}};
    return sentence_of(d).find("nowhere on Earth (9.76 to 9.84)") != std::string::npos;
  };
  EXPECT_TRUE(has_doubt(8.03, 0.08));
  EXPECT_FALSE(has_doubt(9.65, 0.06));  // its interval reaches the Earth's
  d.used.gravity = Vec3(0, 0, -1.62);   // a scene on the Moon
  EXPECT_FALSE(has_doubt(8.03, 0.08));
}

// two named effects of one set are no alternatives to each other
TEST(Sentence, OfTwoEffectsNeitherIsAnAlternativeToTheOther) {
  const Candidate mass = candidate("retune_mass", Family::parameter), drag = candidate("drag", Family::physical);
  Diagnosis d = heavy(mass);
  d.effects.push_back({&drag, {{"drag", "N s/m", 1, 0.9, 1.1}}});
  d.inseparable = {{"retune_mass at tip", "drag at tip"}};
  EXPECT_EQ(sentence_of(d).find("cannot tell"), std::string::npos);
}

}  // namespace
}  // namespace pvg::diagnose
