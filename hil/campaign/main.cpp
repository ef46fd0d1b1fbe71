// rigwire-campaign: the verb `campaign` of rigwire, which starts it, and the schema of its files.
#include "hil/campaign/campaign_verbs.h"
#include "hil/command_line/command_line.h"

int main(int count, char** arguments) {
  rigwire::hil::CompanionVerbs companions;
  companions.campaign = rigwire::hil::campaign_verb;
  companions.campaign_schema = rigwire::hil::campaign_schema;
  return rigwire::hil::run_program(count, arguments, companions);
}
