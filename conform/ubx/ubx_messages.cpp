#include "conform/ubx/ubx_messages.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdio>

#include "protocols/bytes.h"

namespace rigwire::conform {

namespace {

constexpr auto kM8 = UbxDocument::m8;
constexpr auto kF9 = UbxDocument::f9;
constexpr auto kRecordings = UbxDocument::recordings;

using namespace std::string_view_literals;

// clang-format off
constexpr std::array kMessages{
    // What it knows of itself.
    UbxMessage{{0x0A, 0x04}, "MON-VER", kM8, "32.16.13", "swVersion:CH*30 hwVersion:CH*10 [extension:CH*30]"},
    UbxMessage{{0x0A, 0x28}, "MON-GNSS", kM8, "32.16.2", "version:U1 supported:X1 defaultGnss:X1 enabled:X1 simultaneous:U1 _:U1*3"},
    UbxMessage{{0x0A, 0x27}, "MON-PATCH", kM8, "32.16.7", "version:U2 nEntries:U2 [patchInfo:X4 comparatorNumber:U4 patchAddress:U4 patchData:U4]", "nEntries"},
    UbxMessage{{0x27, 0x03}, "SEC-UNIQID", kM8, "32.19.1", "version:U1 _:U1*3 uniqueId:U1*5"},
    UbxMessage{{0x21, 0x08}, "LOG-INFO", kM8, "32.14.5", "version:U1 _:U1*3 filestoreCapacity:U4 _:U1*8 currentMaxLogSize:U4 currentLogSize:U4 entryCount:U4 oldestYear:U2 oldestMonth:U1 oldestDay:U1 oldestHour:U1 oldestMinute:U1 oldestSecond:U1 _:U1 newestYear:U2 newestMonth:U1 newestDay:U1 newestHour:U1 newestMinute:U1 newestSecond:U1 _:U1 status:X1 _:U1*3"},
    // What it monitors.
    UbxMessage{{0x0A, 0x09}, "MON-HW", kM8, "32.16.4", "pinSel:X4 pinBank:X4 pinDir:X4 pinVal:X4 noisePerMS:U2 agcCnt:U2 aStatus:U1 aPower:U1 flags:X1 _:U1 usedMask:X4 VP:U1*17 cwSuppression:U1 _:U1*2 pinIrq:X4 pullH:X4 pullL:X4"},
    UbxMessage{{0x0A, 0x0B}, "MON-HW2", kM8, "32.16.3", "ofsI:I1 magI:U1 ofsQ:I1 magQ:U1 cfgSource:U1 _:U1*3 lowLevCfg:U4 _:U1*8 postStatus:U4 _:U1*4"},
    UbxMessage{{0x0A, 0x02}, "MON-IO", kM8, "32.16.5", "[rxBytes:U4 txBytes:U4 parityErrs:U2 framingErrs:U2 overrunErrs:U2 breakCond:U2 _:U1*4]"},
    UbxMessage{{0x0A, 0x06}, "MON-MSGPP", kM8, "32.16.6", "msg1:U2*8 msg2:U2*8 msg3:U2*8 msg4:U2*8 msg5:U2*8 msg6:U2*8 skipped:U4*6"},
    UbxMessage{{0x0A, 0x07}, "MON-RXBUF", kM8, "32.16.8", "pending:U2*6 usage:U1*6 peakUsage:U1*6"},
    UbxMessage{{0x0A, 0x08}, "MON-TXBUF", kM8, "32.16.12", "pending:U2*6 usage:U1*6 peakUsage:U1*6 tUsage:U1 tPeakusage:U1 errors:X1 _:U1"},
    UbxMessage{{0x0A, 0x36}, "MON-COMMS", kF9, "3.14.1", "version:U1 nPorts:U1 txErrors:X1 _:U1 protIds:U1*4 [portId:U2 txPending:U2 txBytes:U4 txUsage:U1 txPeakUsage:U1 rxPending:U2 rxBytes:U4 rxUsage:U1 rxPeakUsage:U1 overrunErrs:U2 msgs:U2*4 _:U1*8 skipped:U4]", "nPorts"},
    UbxMessage{{0x0A, 0x38}, "MON-RF", kF9, "3.14.9", "version:U1 nBlocks:U1 _:U1*2 [blockId:U1 flags:X1 antStatus:U1 antPower:U1 postStatus:U4 _:U1*4 noisePerMS:U2 agcCnt:U2 cwSuppression:U1 ofsI:I1 magI:U1 ofsQ:I1 magQ:U1 _:U1*3]", "nBlocks"},
    UbxMessage{{0x27, 0x09}, "SEC-SIG", kF9, "3.18.2", "version:U1 sigSecFlags:X1 _:U1 jamNumCentFreqs:U1 [jamStateCentFreq:X4]", "jamNumCentFreqs"},
    UbxMessage{{0x27, 0x10}, "SEC-SIGLOG", kF9, "3.18.3", "version:U1 numEvents:U1 _:U1*6 [timeElapsed:U4 detectionType:U1 eventType:U1 _:U1*2]", "numEvents"},
    // Where it is.
    UbxMessage{{0x01, 0x01}, "NAV-POSECEF", kM8, "32.17.15", "iTOW:U4 ecefX:I4 ecefY:I4 ecefZ:I4 pAcc:U4"},
    UbxMessage{{0x01, 0x02}, "NAV-POSLLH", kM8, "32.17.16", "iTOW:U4 lon:I4 lat:I4 height:I4 hMSL:I4 hAcc:U4 vAcc:U4"},
    UbxMessage{{0x01, 0x03}, "NAV-STATUS", kM8, "32.17.24", "iTOW:U4 gpsFix:U1 flags:X1 fixStat:X1 flags2:X1 ttff:U4 msss:U4"},
    UbxMessage{{0x01, 0x04}, "NAV-DOP", kM8, "32.17.6", "iTOW:U4 gDOP:U2 pDOP:U2 tDOP:U2 vDOP:U2 hDOP:U2 nDOP:U2 eDOP:U2"},
    UbxMessage{{0x01, 0x06}, "NAV-SOL", kM8, "32.17.23", "iTOW:U4 fTOW:I4 week:I2 gpsFix:U1 flags:X1 ecefX:I4 ecefY:I4 ecefZ:I4 pAcc:U4 ecefVX:I4 ecefVY:I4 ecefVZ:I4 sAcc:U4 pDOP:U2 _:U1 numSV:U1 _:U1*4"},
    UbxMessage{{0x01, 0x07}, "NAV-PVT", kM8, "32.17.17", "iTOW:U4 year:U2 month:U1 day:U1 hour:U1 min:U1 sec:U1 valid:X1 tAcc:U4 nano:I4 fixType:U1 flags:X1 flags2:X1 numSV:U1 lon:I4 lat:I4 height:I4 hMSL:I4 hAcc:U4 vAcc:U4 velN:I4 velE:I4 velD:I4 gSpeed:I4 headMot:I4 sAcc:U4 headAcc:U4 pDOP:U2 flags3:X2 _:U1*4 | headVeh:I4 magDec:I2 magAcc:U2"},
    UbxMessage{{0x01, 0x09}, "NAV-ODO", kM8, "32.17.13", "version:U1 _:U1*3 iTOW:U4 distance:U4 totalDistance:U4 distanceStd:U4"},
    UbxMessage{{0x01, 0x11}, "NAV-VELECEF", kM8, "32.17.33", "iTOW:U4 ecefVX:I4 ecefVY:I4 ecefVZ:I4 sAcc:U4"},
    UbxMessage{{0x01, 0x12}, "NAV-VELNED", kM8, "32.17.34", "iTOW:U4 velN:I4 velE:I4 velD:I4 speed:U4 gSpeed:U4 heading:I4 sAcc:U4 cAcc:U4"},
    UbxMessage{{0x01, 0x13}, "NAV-HPPOSECEF", kM8, "32.17.10", "version:U1 _:U1*3 iTOW:U4 ecefX:I4 ecefY:I4 ecefZ:I4 ecefXHp:I1 ecefYHp:I1 ecefZHp:I1 flags:X1 pAcc:U4"},
    UbxMessage{{0x01, 0x14}, "NAV-HPPOSLLH", kM8, "32.17.11", "version:U1 _:U1*2 flags:X1 iTOW:U4 lon:I4 lat:I4 height:I4 hMSL:I4 lonHp:I1 latHp:I1 heightHp:I1 hMSLHp:I1 hAcc:U4 vAcc:U4"},
    UbxMessage{{0x01, 0x36}, "NAV-COV", kF9, "3.15.2", "iTOW:U4 version:U1 posCovValid:U1 velCovValid:U1 _:U1*9 posCovNN:R4 posCovNE:R4 posCovND:R4 posCovEE:R4 posCovED:R4 posCovDD:R4 velCovNN:R4 velCovNE:R4 velCovND:R4 velCovEE:R4 velCovED:R4 velCovDD:R4"},
    UbxMessage{{0x01, 0x3B}, "NAV-SVIN", kF9, "3.15.21", "version:U1 _:U1*3 iTOW:U4 dur:U4 meanX:I4 meanY:I4 meanZ:I4 meanXHP:I1 meanYHP:I1 meanZHP:I1 _:U1 meanAcc:U4 obs:U4 valid:U1 active:U1 _:U1*2"},
    UbxMessage{{0x01, 0x3C}, "NAV-RELPOSNED", kF9, "3.15.14", "version:U1 _:U1 refStationId:U2 iTOW:U4 relPosN:I4 relPosE:I4 relPosD:I4 relPosLength:I4 relPosHeading:I4 _:U1*4 relPosHPN:I1 relPosHPE:I1 relPosHPD:I1 relPosHPLength:I1 accN:U4 accE:U4 accD:U4 accLength:U4 accHeading:U4 _:U1*4 flags:X4"},
    // What time it is.
    UbxMessage{{0x01, 0x20}, "NAV-TIMEGPS", kM8, "32.17.30", "iTOW:U4 fTOW:I4 week:I2 leapS:I1 valid:X1 tAcc:U4"},
    UbxMessage{{0x01, 0x21}, "NAV-TIMEUTC", kM8, "32.17.32", "iTOW:U4 tAcc:U4 nano:I4 year:U2 month:U1 day:U1 hour:U1 min:U1 sec:U1 valid:X1"},
    UbxMessage{{0x01, 0x22}, "NAV-CLOCK", kM8, "32.17.3", "iTOW:U4 clkB:I4 clkD:I4 tAcc:U4 fAcc:U4"},
    UbxMessage{{0x01, 0x23}, "NAV-TIMEGLO", kM8, "32.17.29", "iTOW:U4 TOD:U4 fTOD:I4 Nt:U2 N4:U1 valid:X1 tAcc:U4"},
    UbxMessage{{0x01, 0x24}, "NAV-TIMEBDS", kM8, "32.17.27", "iTOW:U4 SOW:U4 fSOW:I4 week:I2 leapS:I1 valid:X1 tAcc:U4"},
    UbxMessage{{0x01, 0x25}, "NAV-TIMEGAL", kM8, "32.17.28", "iTOW:U4 galTow:U4 fGalTow:I4 galWno:I2 leapS:I1 valid:X1 tAcc:U4"},
    UbxMessage{{0x01, 0x26}, "NAV-TIMELS", kM8, "32.17.31", "iTOW:U4 version:U1 _:U1*3 srcOfCurrLs:U1 currLs:I1 srcOfLsChange:U1 lsChange:I1 timeToLsEvent:I4 dateOfLsGpsWn:U2 dateOfLsGpsDn:U2 _:U1*3 valid:X1"},
    // What it sees.
    UbxMessage{{0x01, 0x30}, "NAV-SVINFO", kM8, "32.17.25", "iTOW:U4 numCh:U1 globalFlags:X1 _:U1*2 [chn:U1 svid:U1 flags:X1 quality:X1 cno:U1 elev:I1 azim:I2 prRes:I4]", "numCh"},
    UbxMessage{{0x01, 0x31}, "NAV-DGPS", kM8, "32.17.5", "iTOW:U4 age:I4 baseId:I2 baseHealth:I2 numCh:U1 status:U1 _:U1*2 [svid:U1 flags:X1 ageC:U2 prc:R4 prrc:R4]", "numCh"},
    UbxMessage{{0x01, 0x32}, "NAV-SBAS", kM8, "32.17.21", "iTOW:U4 geo:U1 mode:U1 sys:I1 service:X1 cnt:U1 statusFlags:X1 _:U1*2 [svid:U1 _:U1 udre:U1 svSys:U1 svService:U1 _:U1 prc:I2 _:U1*2 ic:I2]", "cnt"},
    UbxMessage{{0x01, 0x34}, "NAV-ORB", kM8, "32.17.14", "iTOW:U4 version:U1 numSv:U1 _:U1*2 [gnssId:U1 svId:U1 svFlag:X1 eph:X1 alm:X1 otherOrb:X1]", "numSv"},
    UbxMessage{{0x01, 0x35}, "NAV-SAT", kM8, "32.17.20", "iTOW:U4 version:U1 numSvs:U1 _:U1*2 [gnssId:U1 svId:U1 cno:U1 elev:I1 azim:I2 prRes:I2 flags:X4]", "numSvs"},
    UbxMessage{{0x01, 0x43}, "NAV-SIG", kF9, "3.15.18", "iTOW:U4 version:U1 numSigs:U1 _:U1*2 [gnssId:U1 svId:U1 sigId:U1 freqId:U1 prRes:I2 cno:U1 qualityInd:U1 corrSource:U1 ionoModel:U1 sigFlags:X2 _:U1*4]", "numSigs"},
    UbxMessage{{0x01, 0x60}, "NAV-AOPSTATUS", kM8, "32.17.1", "iTOW:U4 aopCfg:U1 status:U1 _:U1*10"},
    UbxMessage{{0x02, 0x10}, "RXM-RAW", kRecordings, "RXM-RAW", "iTOW:I4 week:I2 numSV:U1 _:U1 [cpMes:R8 prMes:R8 doMes:R4 sv:U1 mesQI:I1 cno:I1 lli:U1]", "numSV"},
    UbxMessage{{0x02, 0x15}, "RXM-RAWX", kM8, "32.18.4", "rcvTow:R8 week:U2 leapS:I1 numMeas:U1 recStat:X1 _:U1*3 [prMes:R8 cpMes:R8 doMes:R4 gnssId:U1 svId:U1 sigId:U1 freqId:U1 locktime:U2 cno:U1 prStdev:X1 cpStdev:X1 doStdev:X1 trkStat:X1 _:U1]", "numMeas"},
    UbxMessage{{0x02, 0x20}, "RXM-SVSI", kM8, "32.18.8", "iTOW:U4 week:I2 numVis:U1 numSV:U1 [svid:U1 svFlag:X1 azim:I2 elev:I1 age:X1]", "numSV"},
    UbxMessage{{0x0B, 0x01}, "AID-INI", kM8, "32.9.5", "ecefXOrLat:I4 ecefYOrLon:I4 ecefZOrAlt:I4 posAcc:U4 tmCfg:X2 wnoOrDate:U2 towOrTime:U4 towNs:I4 tAccMs:U4 tAccNs:U4 clkDOrFreq:I4 clkDAccOrFreqAcc:U4 flags:X4"},
    UbxMessage{{0x0B, 0x02}, "AID-HUI", kM8, "32.9.4", "health:X4 utcA0:R8 utcA1:R8 utcTOW:I4 utcWNT:I2 utcLS:I2 utcWNF:I2 utcDN:I2 utcLSF:I2 utcSpare:I2 klobA0:R4 klobA1:R4 klobA2:R4 klobA3:R4 klobB0:R4 klobB1:R4 klobB2:R4 klobB3:R4 flags:X4"},
    UbxMessage{{0x0D, 0x01}, "TIM-TP", kM8, "32.20.8", "towMS:U4 towSubMS:U4 qErr:I4 week:U2 flags:X1 refInfo:X1"},
    UbxMessage{{0x0D, 0x03}, "TIM-TM2", kM8, "32.20.6", "ch:U1 flags:X1 count:U2 wnR:U2 wnF:U2 towMsR:U4 towSubMsR:U4 towMsF:U4 towSubMsF:U4 accEst:U4", "", UbxPoll::empty},
    // Its configuration.
    UbxMessage{{0x06, 0x00}, "CFG-PRT", kM8, "32.10.25", "portID:U1 _:U1 txReady:X2 mode:X4 baudRate:U4 inProtoMask:X2 outProtoMask:X2 flags:X2 _:U1*2"},
    UbxMessage{{0x06, 0x01}, "CFG-MSG", kM8, "32.10.18", "msgClass:U1 msgID:U1 rate:U1*6", "", UbxPoll::selected, "\xF0\x04"sv},
    UbxMessage{{0x06, 0x02}, "CFG-INF", kM8, "32.10.15", "[protocolID:U1 _:U1*3 infMsgMask:X1*6]", "", UbxPoll::selected, "\x01"sv},
    UbxMessage{{0x06, 0x06}, "CFG-DAT", kM8, "32.10.4", "datumNum:U2 datumName:CH*6 majA:R8 flat:R8 dX:R4 dY:R4 dZ:R4 rotX:R4 rotY:R4 rotZ:R4 scale:R4"},
    UbxMessage{{0x06, 0x08}, "CFG-RATE", kM8, "32.10.27", "measRate:U2 navRate:U2 timeRef:U2"},
    UbxMessage{{0x06, 0x11}, "CFG-RXM", kM8, "32.10.30", "_:U1 lpMode:U1"},
    UbxMessage{{0x06, 0x13}, "CFG-ANT", kM8, "32.10.1", "flags:X2 pins:X2"},
    UbxMessage{{0x06, 0x16}, "CFG-SBAS", kM8, "32.10.31", "mode:X1 usage:X1 maxSBAS:U1 scanmode2:X1 scanmode1:X4"},
    UbxMessage{{0x06, 0x17}, "CFG-NMEA", kM8, "32.10.21", "filter:X1 nmeaVersion:U1 numSV:U1 flags:X1 gnssToFilter:X4 svNumbering:U1 mainTalkerId:U1 gsvTalkerId:U1 version:U1 | bdsTalkerId:CH*2 _:U1*6"},
    UbxMessage{{0x06, 0x1B}, "CFG-USB", kM8, "32.10.40", "vendorID:U2 productID:U2 _:U1*2 _:U1*2 powerConsumption:U2 flags:X2 vendorString:CH*32 productString:CH*32 serialNumber:CH*32"},
    UbxMessage{{0x06, 0x1E}, "CFG-ODO", kM8, "32.10.22", "version:U1 _:U1*3 flags:U1 odoCfg:X1 _:U1*6 cogMaxSpeed:U1 cogMaxPosAcc:U1 _:U1*2 velLpGain:U1 cogLpGain:U1 _:U1*2"},
    UbxMessage{{0x06, 0x23}, "CFG-NAVX5", kM8, "32.10.20", "version:U2 mask1:X2 mask2:X4 _:U1*2 minSVs:U1 maxSVs:U1 minCNO:U1 _:U1 iniFix3D:U1 _:U1*2 ackAiding:U1 wknRollover:U2 sigAttenCompMode:U1 _:U1*5 usePPP:U1 aopCfg:U1 _:U1*2 aopOrbMaxErr:U2 _:U1*7 useAdr:U1"},
    UbxMessage{{0x06, 0x24}, "CFG-NAV5", kM8, "32.10.19", "mask:X2 dynModel:U1 fixMode:U1 fixedAlt:I4 fixedAltVar:U4 minElev:I1 drLimit:U1 pDop:U2 tDop:U2 pAcc:U2 tAcc:U2 staticHoldThresh:U1 dgnssTimeout:U1 cnoThreshNumSVs:U1 cnoThresh:U1 _:U1*2 staticHoldMaxDist:U2 utcStandard:U1 _:U1*5"},
    UbxMessage{{0x06, 0x31}, "CFG-TP5", kM8, "32.10.38", "tpIdx:U1 version:U1 _:U1*2 antCableDelay:I2 rfGroupDelay:I2 freqPeriod:U4 freqPeriodLock:U4 pulseLenRatio:U4 pulseLenRatioLock:U4 userConfigDelay:I4 flags:X4"},
    UbxMessage{{0x06, 0x34}, "CFG-RINV", kM8, "32.10.28", "flags:X1 [data:U1]"},
    UbxMessage{{0x06, 0x39}, "CFG-ITFM", kM8, "32.10.16", "config:X4 config2:X4"},
    UbxMessage{{0x06, 0x3B}, "CFG-PM2", kM8, "32.10.23", "version:U1 _:U1 maxStartupStateDur:U1 _:U1 flags:X4 updatePeriod:U4 searchPeriod:U4 gridOffset:U4 onTime:U2 minAcqTime:U2 _:U1*20 | extintInactivityMs:U4"},
    UbxMessage{{0x06, 0x3E}, "CFG-GNSS", kM8, "32.10.13", "msgVer:U1 numTrkChHw:U1 numTrkChUse:U1 numConfigBlocks:U1 [gnssId:U1 resTrkCh:U1 maxTrkCh:U1 _:U1 flags:X4]", "numConfigBlocks"},
    UbxMessage{{0x06, 0x47}, "CFG-LOGFILTER", kM8, "32.10.17", "version:U1 flags:X1 minInterval:U2 timeThreshold:U2 speedThreshold:U2 positionThreshold:U4"},
    UbxMessage{{0x06, 0x71}, "CFG-TMODE3", kF9, "3.10.20", "version:U1 _:U1 flags:X2 ecefXOrLat:I4 ecefYOrLon:I4 ecefZOrAlt:I4 ecefXOrLatHP:I1 ecefYOrLonHP:I1 ecefZOrAltHP:I1 _:U1 fixedPosAcc:U4 svinMinDur:U4 svinAccLimit:U4 _:U1*8"},
    UbxMessage{{0x06, 0x86}, "CFG-PMS", kM8, "32.10.24", "version:U1 powerSetupValue:U1 period:U2 onTime:U2 _:U1*2"},
    UbxMessage{{0x06, 0x8B}, "CFG-VALGET", kF9, "3.10.24", "version:U1 layer:U1 position:U2 [cfgData:U1]", "", UbxPoll::selected, "\x00\x00\x00\x00\x01\x00\x21\x30"sv},
    // What is only sent or only taken.
    UbxMessage{{0x05, 0x01}, "ACK-ACK", kM8, "32.8.1", "clsID:U1 msgID:U1", "", UbxPoll::none},
    UbxMessage{{0x05, 0x00}, "ACK-NAK", kM8, "32.8.2", "clsID:U1 msgID:U1", "", UbxPoll::none},
    UbxMessage{{0x01, 0x61}, "NAV-EOE", kM8, "32.17.8", "iTOW:U4", "", UbxPoll::none},
    UbxMessage{{0x06, 0x09}, "CFG-CFG", kM8, "32.10.3", "clearMask:X4 saveMask:X4 loadMask:X4 | deviceMask:X1", "", UbxPoll::none},
    UbxMessage{{0x06, 0x8A}, "CFG-VALSET", kF9, "3.10.25", "version:U1 layers:X1 transaction:U1 _:U1 [cfgData:U1]", "", UbxPoll::none},
    UbxMessage{{0x06, 0x8C}, "CFG-VALDEL", kF9, "3.10.23", "version:U1 layers:X1 transaction:X1 _:U1 [keys:U4]", "", UbxPoll::none},
    UbxMessage{{0x04, 0x00}, "INF-ERROR", kM8, "32.13.2", "[str:CH]", "", UbxPoll::none},
    UbxMessage{{0x04, 0x01}, "INF-WARNING", kM8, "32.13.5", "[str:CH]", "", UbxPoll::none},
    UbxMessage{{0x04, 0x02}, "INF-NOTICE", kM8, "32.13.3", "[str:CH]", "", UbxPoll::none},
};
// clang-format on

std::size_t bytes_of_type(std::string_view type) {
  return type == "CH" ? 1U : static_cast<std::size_t>(type[1] - '0');
}

template <class Value>
Value load(std::span<const std::uint8_t> bytes, std::size_t at) {
  return protocols::load_little<Value>(bytes, at);
}

std::string number_text(double value) {
  std::array<char, 40> text{};
  const bool whole = value == std::floor(value) && std::abs(value) < 1e15;
  std::snprintf(text.data(), text.size(), whole ? "%.0f" : "%.9g", value);
  return text.data();
}

std::string two_digits(std::uint8_t byte) {
  std::array<char, 4> text{};
  std::snprintf(text.data(), text.size(), "%02X", byte);
  return text.data();
}

}  // namespace

std::span<const UbxMessage> ubx_messages() {
  return kMessages;
}

const UbxMessage* ubx_message(protocols::ubx::MessageId id) {
  const auto* const found = std::ranges::find(kMessages, id, &UbxMessage::id);
  return found == kMessages.end() ? nullptr : found;
}

const UbxMessage* ubx_message(std::string_view name) {
  const auto* const found = std::ranges::find(kMessages, name, &UbxMessage::name);
  return found == kMessages.end() ? nullptr : found;
}

std::string source_of(const UbxMessage& message) {
  const std::string section(message.section);
  switch (message.document) {
    case UbxDocument::m8:
      return "UBX-13003221 R28, " + section;
    case UbxDocument::f9:
      return "UBXDOC-963802114-12815, " + section;
    case UbxDocument::recordings:
      break;
  }
  return "Recordings of u-blox 7 receivers";
}

UbxPayload::UbxPayload(const UbxMessage& message, std::vector<std::uint8_t> bytes)
    : message_(&message), bytes_(std::move(bytes)) {
  bool repeated = false;
  for (std::string_view rest = message.fields; !rest.empty();) {
    std::string_view word = rest.substr(0, rest.find(' '));
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
    if (word == "|") {
      shorter_bytes_ = head_bytes_;
      continue;
    }
    if (word.front() == '[') {
      repeated = true;
      word.remove_prefix(1);
    }
    if (word.back() == ']') {
      word.remove_suffix(1);
    }
    const std::size_t colon = word.find(':');
    const std::size_t star = word.find('*');
    Field field{word.substr(0, colon), word.substr(colon + 1, star - colon - 1)};
    if (star != std::string_view::npos) {
      std::from_chars(word.data() + star + 1, word.data() + word.size(), field.count);
    }
    std::size_t& end = repeated ? block_bytes_ : head_bytes_;
    field.offset = end;
    end += bytes_of_type(field.type) * field.count;
    (repeated ? block_ : head_).push_back(field);
  }
  const std::size_t size = bytes_.size();
  if (block_bytes_ == 0) {
    whole_ = size == head_bytes_ || (shorter_bytes_ > 0 && size == shorter_bytes_);
  } else if (size >= head_bytes_) {
    blocks_ = (size - head_bytes_) / block_bytes_;
    whole_ = (size - head_bytes_) % block_bytes_ == 0 &&
             (message.count.empty() || value(message.count) == static_cast<double>(blocks_));
  }
}

std::string UbxPayload::lengths() const {
  std::string text = std::to_string(head_bytes_) + " bytes";
  if (shorter_bytes_ > 0) {
    text = std::to_string(shorter_bytes_) + " or " + text;
  }
  if (block_bytes_ > 0) {
    text += " and " + std::to_string(block_bytes_) + " for each of " +
            (message_->count.empty() ? "its repetitions" : std::string(message_->count));
  }
  return text;
}

const UbxPayload::Field* UbxPayload::find(const std::vector<Field>& in,
                                          std::string_view name) const {
  const auto found = std::ranges::find(in, name, &Field::name);
  return found == in.end() ? nullptr : &*found;
}

bool UbxPayload::has(std::string_view field) const {
  const Field* const found = find(head_, field);
  return found != nullptr &&
         found->offset + bytes_of_type(found->type) * found->count <= bytes_.size();
}

double UbxPayload::read(const Field& field, std::size_t at) const {
  const std::span<const std::uint8_t> bytes = bytes_;
  const char kind = field.type[0];
  switch (bytes_of_type(field.type)) {
    case 1:
      return kind == 'I' ? load<std::int8_t>(bytes, at) : load<std::uint8_t>(bytes, at);
    case 2:
      return kind == 'I' ? load<std::int16_t>(bytes, at) : load<std::uint16_t>(bytes, at);
    case 4:
      if (kind == 'R') {
        return std::bit_cast<float>(load<std::uint32_t>(bytes, at));
      }
      return kind == 'I' ? static_cast<double>(load<std::int32_t>(bytes, at))
                         : static_cast<double>(load<std::uint32_t>(bytes, at));
    default:
      return std::bit_cast<double>(load<std::uint64_t>(bytes, at));
  }
}

double UbxPayload::value(std::string_view field, std::size_t index) const {
  const Field& found = *find(head_, field);
  return read(found, found.offset + index * bytes_of_type(found.type));
}

double UbxPayload::value_in(std::size_t block, std::string_view field) const {
  const Field& found = *find(block_, field);
  return read(found, head_bytes_ + block * block_bytes_ + found.offset);
}

unsigned UbxPayload::bits(std::string_view field, unsigned first, unsigned count) const {
  return static_cast<unsigned>(value(field)) >> first & ((1U << count) - 1U);
}

unsigned UbxPayload::bits_in(std::size_t block, std::string_view field, unsigned first,
                             unsigned count) const {
  return static_cast<unsigned>(value_in(block, field)) >> first & ((1U << count) - 1U);
}

std::string UbxPayload::text(const Field& field, std::size_t base) const {
  std::string text(field.name);
  const std::size_t at = base + field.offset;
  if (field.type == "CH") {
    text += " \"";
    for (std::size_t i = 0; i < field.count && bytes_[at + i] != 0; ++i) {
      const auto c = static_cast<char>(bytes_[at + i]);
      text += c >= 0x20 && c < 0x7F ? c : '?';
    }
    return text + "\"";
  }
  constexpr std::size_t kShown = 8;
  for (std::size_t i = 0; i < std::min(field.count, kShown); ++i) {
    text += " " + number_text(read(field, at + i * bytes_of_type(field.type)));
  }
  return text + (field.count > kShown ? " ..." : "");
}

std::string UbxPayload::words() const {
  std::string words(message_->name);
  if (!whole_) {
    return words + " of " + std::to_string(bytes_.size()) + " bytes";
  }
  const char* between = ": ";
  const auto put = [&](const std::vector<Field>& fields, std::size_t base) {
    for (const Field& field : fields) {
      const std::size_t end = base + field.offset + field.count * bytes_of_type(field.type);
      if (field.name != "_" && end <= bytes_.size()) {
        words += between + text(field, base);
        between = ", ";
      }
    }
  };
  put(head_, 0);
  constexpr std::size_t kShown = 4;
  for (std::size_t i = 0; i < std::min(blocks_, kShown); ++i) {
    between = i == 0 && head_.empty() ? ": " : "; ";
    put(block_, head_bytes_ + i * block_bytes_);
  }
  return words + (blocks_ > kShown ? "; ... " + std::to_string(blocks_) + " in all" : "");
}

std::string ubx_name(protocols::ubx::MessageId id) {
  const UbxMessage* const known = ubx_message(id);
  return known != nullptr
             ? std::string(known->name)
             : "class " + two_digits(id.message_class) + ", id " + two_digits(id.message_id);
}

std::string ubx_words(protocols::ubx::MessageId id, std::span<const std::uint8_t> payload) {
  const UbxMessage* const known = ubx_message(id);
  if (payload.empty()) {
    return "poll of " + ubx_name(id);
  }
  if (known == nullptr) {
    return ubx_name(id) + " of " + std::to_string(payload.size()) + " bytes";
  }
  const bool acknowledges = id.message_class == 0x05 && payload.size() == 2;
  if (acknowledges) {
    return std::string(known->name) + " of " + ubx_name({payload[0], payload[1]});
  }
  return UbxPayload(*known, {payload.begin(), payload.end()}).words();
}

}  // namespace rigwire::conform
