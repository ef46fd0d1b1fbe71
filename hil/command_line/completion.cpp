// Shell completion: verbs, options, rigs, device types. The scripts ask `rigwire list` for names,
// so that they need no renewal when rigs are added.
#include "hil/command_line/verbs.h"

namespace rigwire::hil {

namespace {

constexpr const char* kBash = R"sh(# rigwire completion for bash:  source <(rigwire completion bash)
_rigwire_keys() {  # of the rig that the words name, those that begin with $1
  local rig
  for rig in "${COMP_WORDS[@]:2}"; do
    case $rig in -*|"$1") continue ;; esac
    if [ -f "$rig" ] || rigwire list rigs 2>/dev/null | grep -q "^$rig "; then
      rigwire list keys "$rig" "$1" 2>/dev/null | cut -d' ' -f1
      return
    fi
  done
}
_rigwire() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb=${COMP_WORDS[1]}
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "run picture check list describe schema doctor bench conform ctl record replay campaign completion man --help --version" -- "$word"))
    return
  fi
  case $before in
    --record) COMPREPLY=($(compgen -d -S / -- "$word")); return ;;
    --clock) COMPREPLY=($(compgen -W "real free step drained scaled:" -- "$word")); return ;;
    --status) COMPREPLY=($(compgen -W "live plain none" -- "$word")); return ;;
    --log-level) COMPREPLY=($(compgen -W "debug info warning error" -- "$word")); return ;;
    --layer) COMPREPLY=($(compgen -W "image right disparity range confidence depth labels" -- "$word")); return ;;
    -o|--output|--profile|--expect|--junit|--html|--beside)
      COMPREPLY=($(compgen -f -- "$word")); return ;;
    --set) COMPREPLY=($(compgen -W "$(_rigwire_keys "$word")" -- "$word")); return ;;
    --report|--json|--truth|--lidar-truth|--camera-truth)
      if [ "$verb" = run ] || [ "$verb" = bench ] || [ "$verb" = conform ]; then
        COMPREPLY=($(compgen -f -- "$word")); return
      fi ;;
  esac
  case $verb in
    run) local options="--clock --patience --overrun --overrun-limit --awake --duration --seed --set --report --truth --lidar-truth --camera-truth --record --only --status --log-level --control --dashboard --isolated --ready-fd --dry-run --help" ;;
    picture) local options="--device --at --layer --raw --travel --set --output --help" ;;
    check) local options="--set --log-level --print --json --help" ;;
    list) local options="devices machines scenes rigs campaigns faults keys --json --help" ;;
    describe) local options="$(rigwire list devices 2>/dev/null | cut -d' ' -f1) --json --dbc --bus --units --eds --device --help" ;;
    bench) local options="$(rigwire bench --list 2>/dev/null | cut -d' ' -f1) --json --list --help" ;;
    conform) local options="modbus-tcp modbus-rtu nmea ubx canopen j1939 iso11783-valves velodyne gige-vision --list --listen --limit --profile --make-profile --addresses --address --writes --moves --robustness --allow-remote --expect --json --junit --html --beside --captures --help" ;;
    schema) local options="rig machine scene valve-map dbc-node campaign --help" ;;
    record) local options="info cut export --from --to --topic --output --json --help" ;;
    replay) local options="--verify --json --dashboard --control --ready-fd --clock --loop --speed --from --to --log-level --help" ;;
    ctl) local options="state read pause resume run_until seek step speed wait fault_add fault_clear fault_list events record set stop --follow --only --stop --help" ;;
    campaign) local options="expand run collect report --output --index --html --axes --help" ;;
    completion) local options="bash zsh fish" ;;
    *) local options="--json --help" ;;
  esac
  COMPREPLY=($(compgen -W "$options" -- "$word"))
  if [ "$verb" = campaign ]; then
    COMPREPLY+=($(compgen -W "$(rigwire list campaigns 2>/dev/null | cut -d' ' -f1)" -- "$word"))
    COMPREPLY+=($(compgen -f -X '!*.yaml' -- "$word"))
  fi
  if [ "$verb" = record ] || [ "$verb" = replay ] || [ "$verb" = campaign ]; then
    COMPREPLY+=($(compgen -d -S / -- "$word"))
  fi
  if [ "$verb" = run ] || [ "$verb" = check ] || [ "$verb" = picture ]; then
    COMPREPLY+=($(compgen -W "$(rigwire list rigs 2>/dev/null | cut -d' ' -f1)" -- "$word"))
    COMPREPLY+=($(compgen -f -X '!*.yaml' -- "$word") $(compgen -d -S / -- "$word"))
  fi
}
complete -o nospace -F _rigwire rigwire 2>/dev/null
)sh";

constexpr const char* kZsh = R"sh(#compdef rigwire
# rigwire completion for zsh:  rigwire completion zsh > ~/.zfunc/_rigwire
_rigwire_keys() {  # of the rig that the words name, those that begin with $1
  local rig
  for rig in $words[3,-1]; do
    [[ $rig == -* || $rig == "$1" ]] && continue
    if [[ -f $rig ]] || rigwire list rigs 2>/dev/null | grep -q "^$rig "; then
      rigwire list keys "$rig" "$1" 2>/dev/null | cut -d' ' -f1
      return
    fi
  done
}
_rigwire() {
  local -a verbs
  verbs=(run picture check list describe schema doctor bench conform ctl record replay campaign completion man)
  if (( CURRENT == 2 )); then
    compadd -- $verbs --help --version
    return
  fi
  case $words[CURRENT-1] in
    --clock) compadd -- real free step drained scaled:; return ;;
    --set) compadd -S '' -- ${(f)"$(_rigwire_keys "$PREFIX")"}; return ;;
    --overrun) compadd -- slip warn stop; return ;;
    --status) compadd -- live plain none; return ;;
    --log-level) compadd -- debug info warning error; return ;;
    --layer) compadd -- image right disparity range confidence depth labels; return ;;
    --report|--truth|--lidar-truth|-o|--output) _files; return ;;
    --profile|--expect|--junit|--html|--beside) _files; return ;;
    --record|--camera-truth|--isolated|--captures) _files -/; return ;;
  esac
  case $words[2] in
    run) compadd -- --clock --patience --overrun --overrun-limit --awake --duration --seed --set --report --truth --lidar-truth --camera-truth --record --only --status --log-level --control --dashboard --isolated --ready-fd --dry-run --help ;;
    picture) compadd -- --device --at --layer --raw --travel --set --output --help ;;
    check) compadd -- --set --log-level --print --json --help ;;
    list) compadd -- devices machines scenes rigs campaigns faults keys --json --help ;;
    describe) compadd -- ${(f)"$(rigwire list devices 2>/dev/null | cut -d' ' -f1)"} --json --dbc --bus --units --eds --device ;;
    bench) compadd -- ${(f)"$(rigwire bench --list 2>/dev/null | cut -d' ' -f1)"} --json --list ;;
    conform) compadd -- modbus-tcp modbus-rtu nmea ubx canopen j1939 iso11783-valves velodyne gige-vision --list --listen --limit --profile --make-profile --addresses --address --writes --moves --robustness --allow-remote --expect --json --junit --html --beside --captures --help ;;
    schema) compadd -- rig machine scene valve-map dbc-node campaign ;;
    record) compadd -- info cut export --from --to --topic --output --json --help ;;
    replay) compadd -- --verify --json --dashboard --control --ready-fd --clock --loop --speed --from --to --log-level --help ;;
    ctl) compadd -- state read pause resume run_until seek step speed wait fault_add fault_clear fault_list events record set stop --follow --only --stop --help ;;
    campaign) compadd -- expand run collect report --output --index --html --axes --help ;;
    completion) compadd -- bash zsh fish ;;
    doctor) compadd -- --json --help ;;
  esac
  case $words[2] in
    record|replay) _files -/ ;;
    campaign)
      compadd -- ${(f)"$(rigwire list campaigns 2>/dev/null | cut -d' ' -f1)"}
      _files ;;
    run|picture|check)
      compadd -- ${(f)"$(rigwire list rigs 2>/dev/null | cut -d' ' -f1)"}
      _files -g '*.yaml' ;;
  esac
}
if [ "$funcstack[1]" = "_rigwire" ]; then _rigwire "$@"; else compdef _rigwire rigwire; fi
)sh";

constexpr const char* kFish = R"sh(# rigwire completion for fish:  rigwire completion fish | source
function __rigwire_keys  # of the rig that the words name, those that begin with the last one
  set -l begin (commandline -ct)
  for rig in (commandline -opc)[3..-1]
    string match -q -- '-*' $rig; and continue
    if test -f $rig; or rigwire list rigs 2>/dev/null | string match -qr "^$rig "
      rigwire list keys $rig $begin 2>/dev/null | string replace -r ' .*' ''
      return
    end
  end
end
complete -c rigwire -f
complete -c rigwire -n __fish_use_subcommand -a "run picture check list describe schema doctor bench conform ctl record replay campaign completion man"
complete -c rigwire -n __fish_use_subcommand -l help -d "Help"
complete -c rigwire -n __fish_use_subcommand -l version -d "Version"
complete -c rigwire -n "__fish_seen_subcommand_from run picture check" -a "(rigwire list rigs | string replace -r ' .*' '')"
complete -c rigwire -n "__fish_seen_subcommand_from run picture check" -k -a "(__fish_complete_suffix .yaml)"
complete -c rigwire -n "__fish_seen_subcommand_from run picture check" -l set -x -d "key.path=value" -a "(__rigwire_keys)"
complete -c rigwire -n "__fish_seen_subcommand_from picture" -l device -x
complete -c rigwire -n "__fish_seen_subcommand_from picture" -l at -x
complete -c rigwire -n "__fish_seen_subcommand_from picture" -l layer -x -a "image right disparity range confidence depth labels"
complete -c rigwire -n "__fish_seen_subcommand_from picture" -l raw
complete -c rigwire -n "__fish_seen_subcommand_from picture" -l travel -x
complete -c rigwire -n "__fish_seen_subcommand_from picture" -s o -l output -r -F
complete -c rigwire -n "__fish_seen_subcommand_from run" -l clock -x -a "real free step drained scaled:"
complete -c rigwire -n "__fish_seen_subcommand_from run" -l patience -x
complete -c rigwire -n "__fish_seen_subcommand_from run" -l duration -x
complete -c rigwire -n "__fish_seen_subcommand_from run" -l seed -x
complete -c rigwire -n "__fish_seen_subcommand_from run" -l report -r -F
complete -c rigwire -n "__fish_seen_subcommand_from run" -l truth -r -F
complete -c rigwire -n "__fish_seen_subcommand_from run" -l lidar-truth -r -F
complete -c rigwire -n "__fish_seen_subcommand_from run" -l camera-truth -r -F
complete -c rigwire -n "__fish_seen_subcommand_from run" -l record -x -a "(__fish_complete_directories)"
complete -c rigwire -n "__fish_seen_subcommand_from run" -l only -x
complete -c rigwire -n "__fish_seen_subcommand_from record" -a "info cut export"
complete -c rigwire -n "__fish_seen_subcommand_from record" -a "(__fish_complete_directories)"
complete -c rigwire -n "__fish_seen_subcommand_from replay" -a "(__fish_complete_directories)"
complete -c rigwire -n "__fish_seen_subcommand_from replay" -l verify
complete -c rigwire -n "__fish_seen_subcommand_from replay" -l dashboard
complete -c rigwire -n "__fish_seen_subcommand_from replay" -l control -r -F
complete -c rigwire -n "__fish_seen_subcommand_from replay" -l ready-fd -x
complete -c rigwire -n "__fish_seen_subcommand_from record" -l from -x
complete -c rigwire -n "__fish_seen_subcommand_from record" -l to -x
complete -c rigwire -n "__fish_seen_subcommand_from record" -l topic -x -a "truth transforms antenna statistics events motion joints points"
complete -c rigwire -n "__fish_seen_subcommand_from record" -s o -l output -x -a "(__fish_complete_directories)"
complete -c rigwire -n "__fish_seen_subcommand_from run" -l status -x -a "live plain none"
complete -c rigwire -n "__fish_seen_subcommand_from run check" -l log-level -x -a "debug info warning error"
complete -c rigwire -n "__fish_seen_subcommand_from run" -l control -r -F
complete -c rigwire -n "__fish_seen_subcommand_from run" -l overrun -x -a "slip warn stop"
complete -c rigwire -n "__fish_seen_subcommand_from run" -l overrun-limit -x
complete -c rigwire -n "__fish_seen_subcommand_from run" -l isolated -x -a "(__fish_complete_directories)"
complete -c rigwire -n "__fish_seen_subcommand_from run" -l ready-fd -x
complete -c rigwire -n "__fish_seen_subcommand_from run" -l dry-run
complete -c rigwire -n "__fish_seen_subcommand_from check" -l print
complete -c rigwire -n "__fish_seen_subcommand_from check list describe doctor record replay" -l json
complete -c rigwire -n "__fish_seen_subcommand_from list" -a "devices machines scenes rigs campaigns faults keys"
complete -c rigwire -n "__fish_seen_subcommand_from describe" -a "(rigwire list devices | string replace -r ' .*' '')"
complete -c rigwire -n "__fish_seen_subcommand_from bench" -a "(rigwire bench --list | string replace -r ' .*' '')"
complete -c rigwire -n "__fish_seen_subcommand_from bench" -l json -r -F
complete -c rigwire -n "__fish_seen_subcommand_from conform" -a "modbus-tcp modbus-rtu nmea ubx canopen j1939 iso11783-valves velodyne gige-vision"
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l list
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l make-profile
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l writes
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l robustness
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l allow-remote
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l profile -r -F
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l expect -r -F
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l json -r -F
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l junit -r -F
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l html -r -F
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l beside -r -F
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l addresses -x
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l address -x
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l moves -x
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l listen -x
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l limit -x
complete -c rigwire -n "__fish_seen_subcommand_from conform" -l captures -x -a "(__fish_complete_directories)"
complete -c rigwire -n "__fish_seen_subcommand_from schema" -a "rig machine scene valve-map dbc-node campaign"
complete -c rigwire -n "__fish_seen_subcommand_from ctl" -a "state read pause resume run_until seek step speed wait fault_add fault_clear fault_list events record set stop"
complete -c rigwire -n "__fish_seen_subcommand_from ctl" -l follow
complete -c rigwire -n "__fish_seen_subcommand_from ctl" -l only -x
complete -c rigwire -n "__fish_seen_subcommand_from ctl" -l stop
complete -c rigwire -n "__fish_seen_subcommand_from campaign" -a "expand run collect report (rigwire list campaigns | string replace -r ' .*' '')"
complete -c rigwire -n "__fish_seen_subcommand_from campaign" -k -a "(__fish_complete_suffix .yaml)"
complete -c rigwire -n "__fish_seen_subcommand_from campaign" -s o -l output -x -a "(__fish_complete_directories)"
complete -c rigwire -n "__fish_seen_subcommand_from campaign" -l index -x
complete -c rigwire -n "__fish_seen_subcommand_from campaign" -l html -r -F
complete -c rigwire -n "__fish_seen_subcommand_from campaign" -l axes -x
complete -c rigwire -n "__fish_seen_subcommand_from completion" -a "bash zsh fish"
)sh";

}  // namespace

int completion_verb(const std::string& shell, Terminal terminal) {
  if (shell == "bash") {
    terminal.out << kBash;
  } else if (shell == "zsh") {
    terminal.out << kZsh;
  } else if (shell == "fish") {
    terminal.out << kFish;
  } else {
    return refuse_word("shell", shell, {"bash", "zsh", "fish"}, terminal);
  }
  return static_cast<int>(ExitCode::done);
}

}  // namespace rigwire::hil
