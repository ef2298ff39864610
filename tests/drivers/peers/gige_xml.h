// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

namespace dubsar::test {

/// Where the emulated camera keeps what Aravis's fake camera knows nothing of.
enum Register : unsigned {
  kOutputMode = 0x2104,
  kSelector = 0x2108,
  kInvalidFlag = 0x210c,
  kInvalidValue = 0x2110,  // double
  kScales = 0x2200,        // three doubles
  kOffsets = 0x2240,       // three doubles
  kEncoder = 0x2300,
  kLight = 0x2400,
  kExposureAuto = 0x2404,
  kGainAuto = 0x2408,
  kGain = 0x240c,
  kPayloadLie = 0x2500,  // bytes that the announced payload is short of
};

/// A GenICam description of a range camera that can send pictures as well. Names are those of the SFNC.
inline std::string range_camera_xml() {
  const auto hex = [](unsigned address) {
    char text[16];
    std::snprintf(text, sizeof text, "0x%x", address);
    return std::string(text);
  };
  const auto reg = [&](const std::string& name, unsigned address, const std::string& more = "") {
    return "<IntReg Name='" + name + "'><Address>" + hex(address) + "</Address><Length>4</Length>" +
           "<AccessMode>RW</AccessMode><pPort>Device</pPort><Cachable>NoCache</Cachable>" + more +
           "<Sign>Unsigned</Sign><Endianess>BigEndian</Endianess></IntReg>\n";
  };
  const auto integer = [&](const std::string& name, unsigned address, long low, long high) {
    return "<Integer Name='" + name + "' NameSpace='Standard'><pValue>" + name + "Reg</pValue><Min>" +
           std::to_string(low) + "</Min><Max>" + std::to_string(high) + "</Max></Integer>\n" +
           reg(name + "Reg", address);
  };
  const auto entry = [](const std::string& name, const std::string& value) {
    return "<EnumEntry Name='" + name + "'><Value>" + value + "</Value></EnumEntry>";
  };
  const auto choice = [&](const std::string& name, unsigned address, const std::string& entries,
                          const std::string& more = "") {
    return "<Enumeration Name='" + name + "' NameSpace='Standard'>" + entries + "<pValue>" + name +
           "Reg</pValue>" + more + "</Enumeration>\n" + reg(name + "Reg", address);
  };
  const auto command = [&](const std::string& name, const std::string& to, int value) {
    return "<Command Name='" + name + "' NameSpace='Standard'><pValue>" + to + "</pValue><CommandValue>" +
           std::to_string(value) + "</CommandValue></Command>\n";
  };
  const auto text = [&](const std::string& name, unsigned address) {
    return "<StringReg Name='" + name + "' NameSpace='Standard'><Address>" + hex(address) +
           "</Address><Length>32</Length><AccessMode>RO</AccessMode><pPort>Device</pPort></StringReg>\n";
  };
  const auto selected = [&](const std::string& name, unsigned base) {
    return "<IntSwissKnife Name='" + name +
           "At'><pVariable Name='S'>Scan3dCoordinateSelectorReg</pVariable><Formula>" + std::to_string(base) +
           " + S * 8</Formula></IntSwissKnife>\n<Float Name='" + name + "' NameSpace='Standard'><pValue>" +
           name + "Reg</pValue></Float>\n<FloatReg Name='" + name + "Reg'><pAddress>" + name +
           "At</pAddress><Length>8</Length><AccessMode>RW</AccessMode><pPort>Device</"
           "pPort><Cachable>NoCache</Cachable>"
           "<Endianess>BigEndian</Endianess></FloatReg>\n";
  };
  std::string out =
      "<?xml version='1.0' encoding='utf-8'?>\n<RegisterDescription ModelName='Peer' VendorName='Dubsar' "
      "ToolTip='An emulated range camera' StandardNameSpace='GEV' SchemaMajorVersion='1' "
      "SchemaMinorVersion='1' "
      "SchemaSubMinorVersion='0' MajorVersion='1' MinorVersion='0' SubMinorVersion='0' "
      "ProductGuid='8d2f1f1e-0000-4000-8000-000000000001' VersionGuid='8d2f1f1e-0000-4000-8000-000000000002' "
      "xmlns='http://www.genicam.org/GenApi/Version_1_1'>\n";
  out += "<Category Name='Root' NameSpace='Standard'>";
  for (const char* name : {"DeviceVendorName",
                           "DeviceModelName",
                           "SensorWidth",
                           "SensorHeight",
                           "Width",
                           "Height",
                           "OffsetX",
                           "OffsetY",
                           "PixelFormat",
                           "AcquisitionMode",
                           "AcquisitionStart",
                           "AcquisitionStop",
                           "AcquisitionFrameRate",
                           "ExposureTime",
                           "ExposureAuto",
                           "GainAuto",
                           "GainRaw",
                           "TriggerSelector",
                           "TriggerMode",
                           "TriggerSource",
                           "TriggerActivation",
                           "TriggerSoftware",
                           "Scan3dOutputMode",
                           "Scan3dDistanceUnit",
                           "Scan3dCoordinateSelector",
                           "Scan3dCoordinateScale",
                           "Scan3dCoordinateOffset",
                           "Scan3dInvalidDataFlag",
                           "Scan3dInvalidDataValue",
                           "EncoderValue",
                           "LightBrightness",
                           "PayloadSize"}) {
    out += "<pFeature>" + std::string(name) + "</pFeature>";
  }
  out += "</Category>\n";
  out += text("DeviceVendorName", 0x48) + text("DeviceModelName", 0x68);
  out += integer("SensorWidth", 0x11c, 1, 4096) + integer("SensorHeight", 0x118, 1, 4096);
  out += integer("Width", 0x100, 1, 4096) + integer("Height", 0x104, 1, 4096);
  out += integer("OffsetX", 0x130, 0, 4096) + integer("OffsetY", 0x134, 0, 4096);
  out += choice("PixelFormat", 0x128,
                entry("Mono8", "0x01080001") + entry("Mono16", "0x01100007") +
                    entry("Mono12Packed", "0x010C0006") + entry("Coord3D_C16", "0x011000B8") +
                    entry("Coord3D_C32f", "0x012000BF") + entry("Coord3D_AC16", "0x022000BB") +
                    entry("Coord3D_ABC32f", "0x026000C0"));
  out += choice("AcquisitionMode", 0x12c, entry("Continuous", "1") + entry("SingleFrame", "2"));
  out += reg("AcquisitionReg", 0x124) + command("AcquisitionStart", "AcquisitionReg", 1) +
         command("AcquisitionStop", "AcquisitionReg", 0);
  // A period in the register, a rate for people. The least of 1 keeps Aravis from dividing by nothing.
  out +=
      "<Float Name='AcquisitionFrameRate' NameSpace='Standard'><pValue>RateOfPeriod</pValue><Min>0.5</Min>"
      "<Max>20000</Max><Unit>Hz</Unit></Float>\n<Converter Name='RateOfPeriod'><FormulaTo>1e6 / "
      "FROM</FormulaTo>"
      "<FormulaFrom>1e6 / TO</FormulaFrom><pValue>Period</pValue></Converter>\n<Integer "
      "Name='Period'><pValue>PeriodReg"
      "</pValue><Min>1</Min><Max>2000000</Max></Integer>\n" +
      reg("PeriodReg", 0x138);
  out +=
      "<Float Name='ExposureTime' "
      "NameSpace='Standard'><pValue>ExposureOfReg</pValue><Min>10</Min><Max>1000000</Max>"
      "<Unit>us</Unit></Float>\n<Converter "
      "Name='ExposureOfReg'><FormulaTo>FROM</FormulaTo><FormulaFrom>TO</FormulaFrom>"
      "<pValue>ExposureReg</pValue></Converter>\n" +
      reg("ExposureReg", 0x120);
  const std::string automatic = entry("Off", "0") + entry("Continuous", "2");
  out += choice("ExposureAuto", kExposureAuto, automatic) + choice("GainAuto", kGainAuto, automatic);
  out += integer("GainRaw", kGain, 0, 48);
  out += choice("TriggerSelector", 0x2004, entry("FrameStart", "0"));
  out += choice("TriggerMode", 0x300, entry("Off", "0") + entry("On", "1"));
  out += choice("TriggerSource", 0x304, entry("Line0", "0") + entry("Software", "1"));
  out += choice("TriggerActivation", 0x308, entry("RisingEdge", "0"));
  out += reg("TriggerSoftwareReg", 0x30c) + command("TriggerSoftware", "TriggerSoftwareReg", 1);
  out += choice("Scan3dOutputMode", kOutputMode,
                entry("RectifiedC", "0") + entry("CalibratedABC_Grid", "1") + entry("CalibratedAC", "2") +
                    entry("UncalibratedC", "3"));
  out += choice("Scan3dDistanceUnit", 0x2100, entry("Millimeter", "0") + entry("Inch", "1"));
  out += choice("Scan3dCoordinateSelector", kSelector,
                entry("CoordinateA", "0") + entry("CoordinateB", "1") + entry("CoordinateC", "2"),
                "<pSelected>Scan3dCoordinateScale</pSelected><pSelected>Scan3dCoordinateOffset</pSelected>");
  out += selected("Scan3dCoordinateScale", kScales) + selected("Scan3dCoordinateOffset", kOffsets);
  out +=
      "<Boolean Name='Scan3dInvalidDataFlag' "
      "NameSpace='Standard'><pValue>InvalidFlagReg</pValue><OnValue>1</OnValue>"
      "<OffValue>0</OffValue></Boolean>\n" +
      reg("InvalidFlagReg", kInvalidFlag);
  out +=
      "<Float Name='Scan3dInvalidDataValue' "
      "NameSpace='Standard'><pValue>InvalidReg</pValue></Float>\n<FloatReg "
      "Name='InvalidReg'><Address>" +
      hex(kInvalidValue) +
      "</Address><Length>8</Length><AccessMode>RW</AccessMode><pPort>Device</pPort><Cachable>NoCache</"
      "Cachable>"
      "<Endianess>BigEndian</Endianess></FloatReg>\n";
  out += integer("EncoderValue", kEncoder, 0, 2000000000) + integer("LightBrightness", kLight, 0, 100);
  out += reg("LieReg", kPayloadLie);
  out +=
      "<IntSwissKnife Name='PayloadSize' NameSpace='Standard'><pVariable "
      "Name='W'>WidthReg</pVariable><pVariable "
      "Name='H'>HeightReg</pVariable><pVariable Name='P'>PixelFormatReg</pVariable><pVariable Name='L'>LieReg"
      "</pVariable><Formula>W * H * ((P &gt;&gt; 16) &amp; 0xFF) / 8 - L</Formula></IntSwissKnife>\n";
  out += "<Port Name='Device' NameSpace='Standard'/>\n</RegisterDescription>\n";
  return out;
}

}  // namespace dubsar::test
