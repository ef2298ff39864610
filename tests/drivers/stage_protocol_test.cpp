// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the controllers' languages say, byte by byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/usb_stage/grbl_protocol.h"
#include "drivers/usb_stage/horus_protocol.h"
#include "drivers/usb_stage/lines.h"
#include "drivers/usb_stage/options.h"
#include "drivers/usb_stage/tmcl_protocol.h"
#include "drivers/usb_stage/usb_link.h"
#include "tests/support/comma_locale.h"

namespace dubsar::usb_stage {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(StageLines, ComeWholeHoweverTheBytesCome) {
  LineSplitter lines;
  lines.add("o");
  EXPECT_FALSE(lines.next());
  lines.add("k\r\n\r\nerr");
  EXPECT_EQ(lines.next(), "ok");
  EXPECT_FALSE(lines.next());
  lines.add("or:\x01\xff\n");
  EXPECT_EQ(lines.next(), "error:??");
  lines.add(std::string(3 * LineSplitter::kLongest, 'x'));
  EXPECT_EQ(lines.next()->size(), LineSplitter::kLongest);
}

TEST(Grbl, ReportsHaveFieldsInAnyOrder) {
  const auto report = std::get<grbl::Report>(grbl::parse("<Idle|MPos:0.000,-1.500,3.25|FS:0,0|WCO:1,2,3>"));
  EXPECT_EQ(report.state, grbl::State::kIdle);
  EXPECT_THAT(*report.machine, ElementsAre(0, -1.5, 3.25));
  EXPECT_THAT(*report.offset, ElementsAre(1, 2, 3));
  EXPECT_FALSE(report.work);
  const auto held = std::get<grbl::Report>(grbl::parse("<Hold:1|Ov:100,100,100|Pn:XYZ|WPos:7.000>"));
  EXPECT_EQ(held.state, grbl::State::kHold);
  EXPECT_EQ(held.substate, 1);
  EXPECT_THAT(*held.work, ElementsAre(7));
  for (const char* bad :
       {"<Idle>", "<Idle|MPos:>", "<Idle|MPos:1,zwei>", "<Idle|MPos:1e999,2>", "<Lazy|MPos:1>",
        "<Hold:x|MPos:1>", "<Idle|MPos:1,2,3,4,5,6,7>", "<", "<>", "Idle|MPos:1"}) {
    EXPECT_TRUE(std::holds_alternative<grbl::Other>(grbl::parse(bad))) << bad;
  }
}

TEST(Grbl, AnswersAreTold) {
  EXPECT_TRUE(std::holds_alternative<grbl::Ok>(grbl::parse("ok")));
  EXPECT_EQ(std::get<grbl::Fault>(grbl::parse("error:9")).code, 9);
  EXPECT_EQ(std::get<grbl::Alarm>(grbl::parse("ALARM:3")).code, 3);
  EXPECT_EQ(std::get<grbl::Banner>(grbl::parse("Grbl 1.1h ['$' for help]")).version, "1.1h");
  const auto setting = std::get<grbl::Setting>(grbl::parse("$130=200.000"));
  EXPECT_EQ(setting.number, 130);
  EXPECT_EQ(setting.value, 200);
  EXPECT_TRUE(std::holds_alternative<grbl::Other>(grbl::parse("error:nine")));
  EXPECT_EQ(grbl::meaning(grbl::Fault{9}), "it is locked until it is homed");
  EXPECT_EQ(grbl::meaning(grbl::Alarm{77}), "alarm 77");
  EXPECT_EQ(grbl::move('X', -12.5, 600), "G90G21G53G1X-12.5000F600.000");
}

TEST(Horus, SpeaksItsOwnDialect) {
  EXPECT_EQ(std::get<horus::Banner>(horus::parse("Horus 0.2 ['$' for help]")).version, "0.2");
  EXPECT_EQ(std::get<horus::Fault>(horus::parse("error: Undefined feed rate")).text, "Undefined feed rate");
  const auto report = std::get<horus::Report>(horus::parse("<Run,MPos:10.125,WPos:10.125>"));
  EXPECT_TRUE(report.moving);
  EXPECT_EQ(report.degrees, 10.125);
  EXPECT_EQ(std::get<horus::Number>(horus::parse("512")).value, 512);
  for (const char* bad : {"<Run>", "<Run,MPos:x>", "<Fun,MPos:1>", "Ok", "<Idle|MPos:1,2,3|FS:0,0>"}) {
    EXPECT_TRUE(std::holds_alternative<horus::Other>(horus::parse(bad))) << bad;
  }
  EXPECT_EQ(horus::move(-0.45), "G1X-0.4500");
  EXPECT_EQ(horus::laser(2, true), "M71T2");
}

TEST(Tmcl, FramesAreTheManufacturersOwn) {
  const tmcl::Bytes stop = tmcl::encode({tmcl::Command::kMotorStop, 0, 0, 0});
  EXPECT_THAT(stop, ElementsAre(1, 3, 0, 0, 0, 0, 0, 0, 4));
  EXPECT_THAT(tmcl::encode({tmcl::Command::kMoveTo, 0, 1, -1000}),
              ElementsAre(1, 4, 0, 1, 0xff, 0xff, 0xfc, 0x18, 0x18));
  const tmcl::Bytes reply{2, 1, 100, 6, 0xff, 0xff, 0xff, 0xfe, 0x68};
  const auto decoded = tmcl::decode(reply);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->value, -2);
  EXPECT_TRUE(decoded->good());
  tmcl::Bytes spoilt = reply;
  spoilt[5] ^= 1;
  EXPECT_FALSE(tmcl::decode(spoilt));
}

TEST(Tmcl, TheReplyIsFoundBehindGarbage) {
  const tmcl::Bytes reply{2, 1, 100, 6, 0, 0, 0, 5, 114};
  std::vector<std::uint8_t> bytes{0xff, 2, 1, 100, 6, 0};
  bytes.insert(bytes.end(), reply.begin(), reply.end());
  tmcl::ReplyFinder finder(tmcl::Command::kGetAxis);
  const auto found = finder.add(bytes);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->value, 5);
  tmcl::ReplyFinder other(tmcl::Command::kMoveTo);
  EXPECT_FALSE(other.add(bytes));
}

TEST(StageOptions, AreChecked) {
  const auto parse = [](std::vector<dubsar_option> options) { return parse_options(options); };
  const auto good = parse({{"firmware", "tmcl"},
                           {"axes", "x,y:deg"},
                           {"limits", "0..120,-90..90"},
                           {"steps", "51200,88.9"},
                           {"speed_max", "5,20"}});
  ASSERT_TRUE(good) << good.error().line();
  EXPECT_EQ(good->axes[1].name, "y");
  EXPECT_TRUE(good->axes[1].rotary);
  EXPECT_EQ(good->axes[1].limits->second, 90);
  EXPECT_EQ(good->tmcl.steps, (std::vector{51200, 88.9}));
  EXPECT_EQ(parse({{"axes", "x,y"}, {"steps", "51200"}})->tmcl.steps, (std::vector{51200.0, 51200.0}));
  const auto own = parse({{"axes", "x,y:deg"}, {"limits", "0..120,own"}});
  ASSERT_TRUE(own) << own.error().line();
  EXPECT_EQ(own->axes[0].limits->second, 120);
  EXPECT_FALSE(own->axes[1].limits);
  EXPECT_TRUE(good->tmcl.switches);
  EXPECT_FALSE(parse({{"switches", "no"}})->tmcl.switches);
  // One number is not both microsteps per mm and per degree.
  EXPECT_THAT(parse({{"axes", "x,y:deg"}, {"steps", "51200"}}).error().line(),
              HasSubstr("do not fit the 2 axes; give one for each"));
  for (const dubsar_option& bad :
       {dubsar_option{"firmware", "marlin"}, dubsar_option{"axes", "x,x"}, dubsar_option{"axes", "left"},
        dubsar_option{"limits", "5..1"}, dubsar_option{"limits", "0..1,0..1"}, dubsar_option{"steps", "0"},
        dubsar_option{"steps", "1,"}, dubsar_option{"speed_max", "1,2"}, dubsar_option{"module", "1.5"},
        dubsar_option{"speed_max", "fast"}, dubsar_option{"switches", "maybe"}}) {
    const auto refused = parse({bad});
    ASSERT_FALSE(refused) << bad.key << "=" << bad.value;
    EXPECT_EQ(refused.error().kind, ErrorKind::kUsage);
  }
  EXPECT_THAT(
      parse({{"module", "300"}}).error().line(),
      HasSubstr("module=300 is not understood; module takes of tmcl: the module's address; from 1 to 255"));
}

TEST(UsbNames, AreMakerProductAndSerial) {
  const auto name = UsbName::parse("2341:0043:SN:1");
  ASSERT_TRUE(name);
  EXPECT_EQ(name->serial, "SN:1");
  EXPECT_EQ(name->text(), "2341:0043:SN:1");
  for (const char* bad : {"", "2341", "2341:43", "2341-0043", "x341:0043", "2341:0043x"}) {
    EXPECT_FALSE(UsbName::parse(bad)) << bad;
  }
}

TEST(UsbErrors, NameTheMend) {
  EXPECT_THAT(usb_error(-3, "x", "1:2").line(), HasSubstr("copy 60-dubsar.rules to /etc/udev/rules.d"));
  EXPECT_THAT(usb_error(-6, "x", "1:2").line(), HasSubstr("in use by another program"));
  EXPECT_THAT(usb_error(-4, "x", "1:2").line(), HasSubstr("unplugged"));
}

/// A stage that is told to go to "-0,45" goes to -0.
TEST(StageProtocols, KeepThePointWhateverTheHostsLocale) {
  const test::CommaLocale comma;
  if (!test::CommaLocale::is_set()) {
    GTEST_SKIP() << "no locale with a decimal comma can be made here";
  }
  EXPECT_EQ(grbl::move('X', -12.5, 600), "G90G21G53G1X-12.5000F600.000");
  EXPECT_THAT(*std::get<grbl::Report>(grbl::parse("<Idle|MPos:0.000,-1.500,3.25>")).machine,
              ElementsAre(0, -1.5, 3.25));
  EXPECT_EQ(horus::move(-0.45), "G1X-0.4500");
  EXPECT_EQ(horus::speed(12.5), "G1F12.500");
}

}  // namespace
}  // namespace dubsar::usb_stage
